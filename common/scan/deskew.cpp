// SPDX-License-Identifier: BSD-3-Clause
#include "common/scan/deskew.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kJump_m = 0.3;  // neighbours farther apart than this, or than a tenth of the range, are two surfaces

/// A beam as the laser would have had it at the end of the sweep.
struct Beam {
  double bearing_rad, range_m;
  float raw;  ///< what the sensor said, for a missing return
  bool is_return;
};

/// @param share of the way back to where the sweep began
Beam seen_from_the_end(const Scan& scan, const SensorInfo& sensor, std::size_t beam, const Pose2& T_last_first, double share) {
  const Pose2 T_last_then = interpolate({}, T_last_first, share);
  const Pose2 T_laser_then = sensor.T_base_laser.inverse() * T_last_then * sensor.T_base_laser;
  const float raw = scan.ranges_m[beam];
  if (!is_return(raw, sensor)) return {scan.bearing_rad(beam) + T_laser_then.heading, 0, raw, false};
  const double bearing_rad = scan.bearing_rad(beam), range_m = double{raw};
  const Eigen::Vector2d p = T_laser_then * Eigen::Vector2d(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad));
  return {bearing_rad + wrap_angle(std::atan2(p.y(), p.x()) - bearing_rad), p.norm(), raw, true};
}

/// What lies between two beams, `share` of the way from `a` to `b`.
float between_beams(const Beam& a, const Beam& b, double share) {
  const bool one_surface = a.is_return && b.is_return && std::abs(a.range_m - b.range_m) < std::max(kJump_m, 0.1 * std::min(a.range_m, b.range_m));
  if (one_surface) return static_cast<float>(a.range_m + share * (b.range_m - a.range_m));
  const Beam& nearer = share < 0.5 ? a : b;
  return nearer.is_return ? static_cast<float>(nearer.range_m) : nearer.raw;
}

}  // namespace

Scan deskew(const Scan& scan, const SensorInfo& sensor, const Pose2& T_last_first) {
  const std::size_t beams = scan.ranges_m.size();
  if (beams < 2 || scan.radstep == 0) return scan;
  Scan seen = scan;
  std::fill(seen.ranges_m.begin(), seen.ranges_m.end(), 0.0F);
  const auto beam_at = [&](std::size_t k) {
    return seen_from_the_end(scan, sensor, k, T_last_first, 1.0 - static_cast<double>(k) / static_cast<double>(beams - 1));
  };
  Beam before = beam_at(0);
  for (std::size_t k = 1; k < beams; ++k) {
    const Beam after = beam_at(k);
    // Old bearings that lie between these two beams now; where a near thing now hides a far one the nearer stays.
    const double from = (before.bearing_rad - scan.rad0) / scan.radstep, to = (after.bearing_rad - scan.rad0) / scan.radstep;
    const auto first = static_cast<std::ptrdiff_t>(std::ceil(std::min(from, to) - 1e-9)), last = static_cast<std::ptrdiff_t>(std::floor(std::max(from, to) + 1e-9));
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(first, 0); i <= std::min(last, static_cast<std::ptrdiff_t>(beams) - 1); ++i) {
      const double share = std::abs(to - from) > 1e-9 ? std::clamp((static_cast<double>(i) - from) / (to - from), 0.0, 1.0) : 0.0;
      const float range_m = between_beams(before, after, share);
      float& kept = seen.ranges_m[static_cast<std::size_t>(i)];
      if (!is_return(kept, sensor) || (is_return(range_m, sensor) && range_m < kept)) kept = range_m;
    }
    before = after;
  }
  return seen;
}

}  // namespace modslam
