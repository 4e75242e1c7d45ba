// SPDX-License-Identifier: BSD-3-Clause
#include "common/motion/proposal.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
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

Eigen::Matrix3d information_where_better(const Eigen::Matrix3d& information, const Eigen::Matrix3d& other) {
  // In coordinates in which `information` is the unit matrix the other one has principal directions of its own.
  const Eigen::Matrix3d L = information.llt().matrixL(), L_inverse = L.inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> other_share(L_inverse * other * L_inverse.transpose());
  const Eigen::Vector3d keep = (other_share.eigenvalues().array() < 1.0).cast<double>();
  const Eigen::Matrix3d V = L * other_share.eigenvectors();
  return V * keep.asDiagonal() * V.transpose();
}

Pose2 sample(const Proposal& proposal, std::mt19937_64& random) {
  const double a = gaussian(random), b = gaussian(random), c = gaussian(random);
  const Eigen::Matrix3d L = proposal.covariance.llt().matrixL();
  const Eigen::Vector3d drawn = proposal.T_from_to.vector() + L * Eigen::Vector3d(a, b, c);
  return {drawn[0], drawn[1], wrap_angle(drawn[2])};
}

}  // namespace modslam
