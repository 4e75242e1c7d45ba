// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/door_sensor.hpp"

#include <cmath>

namespace modslam {
namespace {

/// Length of a beam as far as openings care: a missing return went through.
double reach_m(const Scan& scan, const SensorInfo& sensor, int k) {
  const float range_m = scan.ranges_m[static_cast<std::size_t>(k)];
  return is_return(range_m, sensor) ? range_m : sensor.range_max_m;
}

}  // namespace

std::vector<DoorSighting> sight_doors(const Scan& scan, const SensorInfo& sensor, const DoorSensorOptions& options) {
  std::vector<DoorSighting> found;
  const int n = static_cast<int>(scan.ranges_m.size());
  const auto measured = [&](int k) { return is_return(scan.ranges_m[static_cast<std::size_t>(k)], sensor); };
  const auto point = [&](int k) {
    const double r = scan.ranges_m[static_cast<std::size_t>(k)], bearing = scan.bearing_rad(static_cast<std::size_t>(k));
    return Eigen::Vector2d(sensor.T_base_laser * Eigen::Vector2d(r * std::cos(bearing), r * std::sin(bearing)));
  };
  // Once from each side: the nearer jamb is the one whose beam jumps.
  for (const int step : {1, -1}) {
    for (int k = step > 0 ? 0 : n - 1; k + step >= 0 && k + step < n; k += step) {
      if (!measured(k)) continue;
      const double near_m = reach_m(scan, sensor, k);
      if (near_m > options.range_limit_m || reach_m(scan, sensor, k + step) - near_m < options.depth_m) continue;
      int last = k + step;
      while (last >= 0 && last < n && reach_m(scan, sensor, last) - near_m >= options.depth_m) last += step;
      if (last < 0 || last >= n || !measured(last)) continue;
      const double far_m = reach_m(scan, sensor, last), angle_rad = std::abs((last - k) * scan.radstep);
      const double width_m = std::sqrt(near_m * near_m + far_m * far_m - 2 * near_m * far_m * std::cos(angle_rad));
      if (width_m < options.min_width_m || width_m > options.max_width_m) continue;
      found.push_back({point(k), point(last)});
    }
  }
  return found;
}

}  // namespace modslam
