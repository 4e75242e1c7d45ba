// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/truth.hpp"

#include <cstdlib>

namespace modslam {
namespace {

constexpr std::size_t kRecent = 500;  // five seconds of 100 Hz: longer than an estimate takes
constexpr std::int64_t kBeside_us = 20'000;  // a robot at 1 m/s moves 2 cm meanwhile

}  // namespace

void Truth::add(const TimedPose& T_world_base) {
  recent_.push_back(T_world_base);
  if (recent_.size() > kRecent) recent_.pop_front();
  if (T_map_world_) extend(T_world_base.pose);
}

std::optional<double> Truth::add_estimate(std::int64_t utime, const Pose2& T_map_base) {
  std::size_t nearest = recent_.size();
  std::int64_t nearest_us = kBeside_us + 1;
  for (std::size_t i = 0; i < recent_.size(); ++i) {
    const std::int64_t apart_us = std::llabs(recent_[i].utime - utime);
    if (apart_us < nearest_us) nearest = i, nearest_us = apart_us;
  }
  if (nearest == recent_.size()) return std::nullopt;
  if (!T_map_world_) {
    T_map_world_ = T_map_base * recent_[nearest].pose.inverse();
    for (std::size_t i = nearest; i < recent_.size(); ++i) extend(recent_[i].pose);
  }
  return distance(*T_map_world_ * recent_[nearest].pose, T_map_base);
}

void Truth::clear() {
  recent_.clear();
  T_map_world_.reset();
  sketch_.clear();
}

}  // namespace modslam
