// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/tick_log.hpp"

#include <cmath>

namespace modslam {
namespace {

constexpr double kWheelRadius_m = 0.077, kHalfAxle_m = 0.165, kTicksPerTurn = 2000;
constexpr double kLaserAhead_m = 0.145;
constexpr double kRadstep = 2 * kPi / 1024;  // of a URG-04LX
constexpr double kTurn_s = 0.1;              // of its mirror
constexpr int kOtherSensors = 20;
constexpr std::size_t kFewestBeams = 600, kMostBeams = 768;
constexpr double kMillimetre = 0.001;
constexpr std::int64_t kMostTicks = 1LL << 40;

}  // namespace

void TickLog::read(TextFields& fields, Recording& recording) {
  RecordedScan recorded;
  recorded.scan.utime = fields.integer("stamp", 0, 1LL << 53);
  fields.number("second word");
  const std::int64_t left = fields.integer("left wheel ticks", -kMostTicks, kMostTicks);
  const std::int64_t right = fields.integer("right wheel ticks", -kMostTicks, kMostTicks);
  for (int k = 0; k < kOtherSensors; ++k) fields.number("another sensor's word");
  const std::size_t beams = fields.left();
  if (beams < kFewestBeams || beams > kMostBeams)
    throw BadLine("has " + std::to_string(beams) + " ranges, not the " + std::to_string(kFewestBeams) + " to " + std::to_string(kMostBeams) + " of a URG-04LX");
  std::int64_t negative = 0;
  for (std::size_t k = 0; k < beams; ++k) {
    const double range_m = fields.number("a range", 1e6) * kMillimetre;
    negative += range_m < 0;
    recorded.scan.ranges_m.push_back(range_m < 0 ? 0.0F : static_cast<float>(range_m));
  }
  recorded.scan.radstep = kRadstep;
  recorded.scan.rad0 = -kRadstep * static_cast<double>((beams - 1) / 2);
  if (last_) {
    constexpr double kMetresPerTick = 2 * kPi * kWheelRadius_m / kTicksPerTurn;
    const double left_m = kMetresPerTick * static_cast<double>(left - last_->left), right_m = kMetresPerTick * static_cast<double>(right - last_->right);
    const double way_m = 0.5 * (left_m + right_m), turn_rad = 0.5 * (right_m - left_m) / kHalfAxle_m;
    T_odom_base_ = T_odom_base_ * Pose2(way_m * std::cos(turn_rad / 2), way_m * std::sin(turn_rad / 2), turn_rad);
  }
  last_ = Ticks{left, right};
  recorded.T_odom_base = T_odom_base_;
  recording.T_base_laser = Pose2(kLaserAhead_m, 0, 0);
  recording.sweep_s = kTurn_s * kRadstep * static_cast<double>(beams - 1) / (2 * kPi);
  recording.negative_ranges += negative;
  recording.scans.push_back(std::move(recorded));
}

}  // namespace modslam
