// SPDX-License-Identifier: BSD-3-Clause
#include "common/scan/scan.hpp"

namespace modslam {

std::vector<ScanPoint> points_base(const Scan& scan, const SensorInfo& sensor) {
  std::vector<ScanPoint> points;
  points.reserve(scan.ranges_m.size());
  const PointMover to_base(sensor.T_base_laser);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (!is_return(scan.ranges_m[i], sensor)) continue;
    const double range_m = scan.ranges_m[i], bearing_rad = scan.bearing_rad(i);
    const Eigen::Vector2d p_laser(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad));
    points.push_back({to_base * p_laser, range_m, bearing_rad, static_cast<int>(i)});
  }
  return points;
}

}  // namespace modslam
