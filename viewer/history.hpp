// SPDX-License-Identifier: BSD-3-Clause
/// @file What every stream said at every time of the run, within a bounded memory.
#pragma once
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "viewer/outbox.hpp"

namespace modslam {

/// Keeps of every stream the last frame of each interval of message time. When all frames together
/// are larger than the budget, the interval doubles and what is now too many is dropped: a long run
/// is kept whole, only coarser. Safe to use from several threads.
class History {
 public:
  static constexpr std::int64_t kFirstInterval_us = 250'000;

  explicit History(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// @param utime  [us] message time; a stamp that steps back counts as the newest one, 0 as
  /// before the run.
  void add(const std::string& stream, std::int64_t utime, FramePtr frame);
  void clear();

  /// Of each stream the newest frame that is not younger than `utime`; none of streams that began
  /// later. Ordered by stream.
  std::vector<FramePtr> at(std::int64_t utime) const;

  struct Extent {
    std::int64_t begin_utime = 0, end_utime = 0, interval_us = kFirstInterval_us;
    std::size_t bytes = 0;
  };
  Extent extent() const;

 private:
  struct Version {
    std::int64_t utime;
    FramePtr frame;
  };
  void thin();

  mutable std::mutex mutex_;
  std::size_t budget_bytes_;
  Extent extent_;
  std::map<std::string, std::vector<Version>> streams_;  ///< oldest version first
};

}  // namespace modslam
