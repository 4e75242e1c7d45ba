// SPDX-License-Identifier: BSD-3-Clause
#include "common/motion/proposal.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace modslam {
namespace {

double gaussian(std::mt19937_64& random) {
  const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1.0p-53; };
  const double radius = std::sqrt(-2 * std::log(uniform()));
  return radius * std::cos(2 * kPi * uniform());
}

}  // namespace

Proposal fuse(const std::vector<MotionMeasurement>& measurements) {
  // Headings are averaged as differences to the first one: they are close together.
  Eigen::Matrix3d sum = 1e-2 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  const Eigen::Vector3d reference = measurements.front().T_from_to.vector();
  for (const MotionMeasurement& measurement : measurements) {
    Eigen::Vector3d d = measurement.T_from_to.vector() - reference;
    d[2] = wrap_angle(d[2]);
    sum += measurement.information;
    weighted += measurement.information * d;
  }
  const Eigen::Matrix3d covariance = sum.inverse();
  const Eigen::Vector3d mean = reference + covariance * weighted;
  return {{mean[0], mean[1], wrap_angle(mean[2])}, covariance};
}

Pose2 sample(const Proposal& proposal, std::mt19937_64& random) {
  const double a = gaussian(random), b = gaussian(random), c = gaussian(random);
  const Eigen::Matrix3d L = proposal.covariance.llt().matrixL();
  const Eigen::Vector3d drawn = proposal.T_from_to.vector() + L * Eigen::Vector3d(a, b, c);
  return {drawn[0], drawn[1], wrap_angle(drawn[2])};
}

}  // namespace modslam
