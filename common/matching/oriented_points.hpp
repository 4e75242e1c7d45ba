// SPDX-License-Identifier: BSD-3-Clause
/// @file Scan points with the direction of the surface they lie on.
#pragma once
#include <vector>

#include "common/scan/scan.hpp"

namespace modslam {

/// What is known of the range noise; from the data sheets of common 2D lasers.
struct RangeNoise {
  double sigma_range_m = 0.012;    ///< along the beam
  double sigma_bearing_rad = 1e-3; ///< across the beam
};

struct OrientedPoint {
  Eigen::Vector2d p;      ///< [m]
  Eigen::Vector2d n;      ///< unit normal, towards the sensor; zero when there is no surface
  float var_m2;           ///< variance of the point along n (along the beam when there is no surface)
  float var_normal_rad2;  ///< variance of the direction of n
  bool has_normal() const { return n != Eigen::Vector2d::Zero(); }
};

/// Points of a scan in the robot frame with surface normals by total least squares over the neighbouring
/// beams, up to a depth jump. Points closer than `spacing_m` to the last kept one are left out.
std::vector<OrientedPoint> orient(const Scan& scan, const SensorInfo& sensor, const RangeNoise& noise,
                                  double range_limit_m, double spacing_m);

}  // namespace modslam
