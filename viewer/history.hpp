// SPDX-License-Identifier: BSD-3-Clause
/// @file What every stream said at every time of the run, in memory that is taken once.
#pragma once
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "viewer/outbox.hpp"

namespace modslam {

/// Keeps of every stream the last frame of each interval of message time, packed. When the memory is
/// full, the interval doubles and what is now too many is dropped: a long run is kept whole, only
/// coarser. Safe to use from several threads.
class History {
 public:
  static constexpr std::int64_t kFirstInterval_us = 250'000;

  /// @param budget_bytes  taken from the machine now, so that a run needs no more after ten hours than
  /// at its start. 0: nothing is kept.
  explicit History(std::size_t budget_bytes) : arena_(budget_bytes) {}

  /// @param utime  [us] message time; a stamp that steps back counts as the newest one, 0 as
  /// before the run. A frame that does not fit beside the newest one of every other stream is not kept.
  void add(const std::string& stream, std::int64_t utime, const FramePtr& frame);
  void clear();

  /// Of each stream the newest frame that is not younger than `utime`; none of streams that began
  /// later. Ordered by stream.
  std::vector<FramePtr> at(std::int64_t utime) const;

  struct Extent {
    std::int64_t begin_utime = 0, end_utime = 0, interval_us = kFirstInterval_us;
    std::size_t bytes = 0;  ///< of what is kept
  };
  Extent extent() const;

 private:
  /// Stands in the arena before the packed bytes of a frame; records follow each other in the order of time.
  struct Record {
    std::int64_t utime;
    std::uint32_t stream, packed_size, size;
    bool binary, alive;
  };
  static constexpr std::size_t kNone = SIZE_MAX;
  struct Stream {
    std::uint32_t number;
    std::size_t newest = kNone;  ///< where its newest record lies
  };
  Record record(std::size_t offset) const;
  FramePtr frame(std::size_t offset) const;
  void kill(std::size_t offset);
  bool make_room(std::size_t bytes);
  void drop_all_but_last_of_interval();
  void close_gaps();

  mutable std::mutex mutex_;
  Extent extent_;
  std::vector<char> arena_;
  std::size_t end_ = 0;  ///< of the records
  std::map<std::string, Stream> streams_;
};

}  // namespace modslam
