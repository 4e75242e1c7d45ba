// SPDX-License-Identifier: BSD-3-Clause
/// @file Recent odometry by time, for "where did odometry say the robot was when this scan was taken?"
#pragma once
#include <cstdint>
#include <deque>
#include <optional>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// Stamps may step back (some real logs do, by up to a second): what counts is the order of arrival, and a time is looked up
/// from the newest end.
class OdometryBuffer {
 public:
  explicit OdometryBuffer(std::size_t kept = 400) : kept_(kept) {}
  void add(std::int64_t utime, const Pose2& T_odom_base);
  /// Interpolated pose at `utime`; nothing when the buffer does not reach that far (yet).
  std::optional<Pose2> at(std::int64_t utime) const;
  /// Where the robot was at the first beam of a sweep that ended at `utime`, seen from where it was then; nothing when either is not known.
  std::optional<Pose2> during(std::int64_t utime, double sweep_s) const;
  /// The last pose that came in, whatever its time.
  std::optional<Pose2> newest() const;
  std::int64_t newest_utime() const { return entries_.empty() ? 0 : entries_.back().utime; }
  std::int64_t backward_steps() const { return backward_steps_; }
  bool empty() const { return entries_.empty(); }

 private:
  struct Entry {
    std::int64_t utime;
    Pose2 pose;
  };
  std::size_t kept_;
  std::deque<Entry> entries_;
  std::int64_t backward_steps_ = 0;
};

}  // namespace modslam
