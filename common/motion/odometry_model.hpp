// SPDX-License-Identifier: BSD-3-Clause
/// @file How much an odometer is believed.
#pragma once
#include <Eigen/Core>

#include "common/config/visitor.hpp"
#include "common/geometry/pose2.hpp"

namespace modslam {

/// Deliberately wide: real odometers slip, have wrong scales and even lose the sign of reverse driving.
struct OdometryModelConfig {
  static constexpr const char* kTable = "odometry_model";
  double sigma_m = 0.005;
  double sigma_per_m = 0.20;
  double sigma_rad = 0.004;
  double sigma_rad_per_rad = 0.15;
  double sigma_rad_per_m = 0.05;
  double ins_sigma_rad = 0.004;
  double ins_sigma_rad_per_rad = 0.05;

  void visit(ConfigVisitor& v) {
    v.number("sigma_m", sigma_m, 1e-4, 0.5, "m", "Position noise of one odometry step, whatever its length.");
    v.number("sigma_per_m", sigma_per_m, 0, 2, "m/m", "Position noise for each metre driven.");
    v.number("sigma_rad", sigma_rad, 1e-5, 0.5, "rad", "Heading noise of one odometry step.");
    v.number("sigma_rad_per_rad", sigma_rad_per_rad, 0, 2, "rad/rad", "Heading noise for each radian turned.");
    v.number("sigma_rad_per_m", sigma_rad_per_m, 0, 2, "rad/m", "Heading noise for each metre driven.");
    v.number("ins_sigma_rad", ins_sigma_rad, 1e-5, 0.5, "rad", "Heading noise of one step of the INS.");
    v.number("ins_sigma_rad_per_rad", ins_sigma_rad_per_rad, 0, 2, "rad/rad", "Heading noise of the INS for each radian turned.");
  }
};

/// Covariance of a motion as odometry measured it; additive in (x, y, heading) of the frame it starts from.
inline Eigen::Matrix3d odometry_covariance(const Pose2& T_from_to, const OdometryModelConfig& model) {
  const double metres = std::hypot(T_from_to.x, T_from_to.y), radians = std::abs(T_from_to.heading);
  const double sigma_m = model.sigma_m + model.sigma_per_m * metres;
  const double sigma_rad = model.sigma_rad + model.sigma_rad_per_rad * radians + model.sigma_rad_per_m * metres;
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
}

/// Information of a turn as an INS measured it: heading only.
inline Eigen::Matrix3d ins_information(double turn_rad, const OdometryModelConfig& model) {
  const double sigma_rad = model.ins_sigma_rad + model.ins_sigma_rad_per_rad * std::abs(turn_rad);
  return Eigen::Vector3d(0, 0, 1 / (sigma_rad * sigma_rad)).asDiagonal();
}

}  // namespace modslam
