// SPDX-License-Identifier: BSD-3-Clause
/// @file One sweep of a planar laser and what is known of the sensor. Trusted data: the bus has checked it.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// Mount and limits of a laser (message sensor_info_t).
struct SensorInfo {
  Pose2 T_base_laser;
  double range_min_m = 0.05;       ///< shorter values are missing returns
  double range_max_m = 80.0;       ///< values at or above it are missing returns
  bool no_return_is_free = false;  ///< true: a missing return means free space up to range_max_m
  double sweep_s = 0.0;            ///< from the first to the last beam, whose time is the scan's utime; 0 = at once
};

/// One sweep. Beam i points to rad0 + i * radstep in the laser frame.
struct Scan {
  std::int64_t utime = 0;
  std::vector<float> ranges_m;  ///< as the sensor gave them; finite or not, is_return() decides
  double rad0 = 0, radstep = 0;

  double bearing_rad(std::size_t beam) const { return rad0 + static_cast<double>(beam) * radstep; }
};

/// Whether a range is a measured point. False for missing returns, zeros, NaN, infinities.
inline bool is_return(float range_m, const SensorInfo& sensor) {
  return range_m >= sensor.range_min_m && range_m < sensor.range_max_m;  // NaN compares false
}

/// A measured point and the beam that saw it.
struct ScanPoint {
  Eigen::Vector2d p;    ///< [m] in the frame asked for
  double range_m;       ///< from the laser
  double bearing_rad;   ///< in the laser frame
  int beam;
};

/// The returns of a scan as points of the robot frame, in beam order.
std::vector<ScanPoint> points_base(const Scan& scan, const SensorInfo& sensor);

}  // namespace modslam
