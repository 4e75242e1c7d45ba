// SPDX-License-Identifier: BSD-3-Clause
#include "common/motion/odometry_buffer.hpp"

#include <cmath>

namespace modslam {

void OdometryBuffer::add(std::int64_t utime, const Pose2& T_odom_base) {
  if (!entries_.empty() && utime <= entries_.back().utime) ++backward_steps_;
  entries_.push_back({utime, T_odom_base});
  if (entries_.size() > kept_) entries_.pop_front();
}

std::optional<Pose2> OdometryBuffer::at(std::int64_t utime) const {
  if (entries_.empty()) return std::nullopt;
  if (entries_.back().utime == utime) return entries_.back().pose;
  for (std::size_t k = entries_.size() - 1; k > 0; --k) {
    const Entry &before = entries_[k - 1], &after = entries_[k];
    if (before.utime == utime) return before.pose;
    if (before.utime <= utime && utime <= after.utime && before.utime < after.utime) {
      const double share = static_cast<double>(utime - before.utime) / static_cast<double>(after.utime - before.utime);
      return interpolate(before.pose, after.pose, share);
    }
  }
  return std::nullopt;
}

std::optional<Pose2> OdometryBuffer::newest() const {
  if (entries_.empty()) return std::nullopt;
  return entries_.back().pose;
}

std::optional<Pose2> OdometryBuffer::during(std::int64_t utime, double sweep_s) const {
  const std::optional<Pose2> last = at(utime), first = at(utime - std::llround(sweep_s * 1e6));
  if (!last || !first) return std::nullopt;
  return between(*last, *first);
}

}  // namespace modslam
