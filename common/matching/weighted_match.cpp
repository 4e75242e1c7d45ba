// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/weighted_match.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kFloor2 = 1e-6;             // m^2: no pair is known better than a millimetre
constexpr double kLargestSpread_m = 0.5;     // of two points on one surface
constexpr double kChi2_2dof_99 = 9.21;
constexpr double kStop_m = 1e-4, kStop_rad = 1e-5, kShrink = 0.8;
constexpr int kFewestPairs = 5;

/// What one point is wrong by, in the frame of its robot.
struct NoisyPoint {
  Eigen::Vector2d p;
  double bearing_rad;           ///< from its laser
  Eigen::Matrix2d measured;     ///< range and bearing noise, and the bias along the beam
  Eigen::Matrix2d along;        ///< spread of the partner along the surface; isotropic where no surface is known
  bool has_surface;
};

NoisyPoint noisy(const OrientedPoint& point, const Eigen::Vector2d& eye, const WeightedMatchOptions& options) {
  NoisyPoint out{point.p, 0, Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero(), point.has_normal()};
  const Eigen::Vector2d d = point.p - eye;
  const double range_m = std::max(d.norm(), 1e-3), sigma_range2 = options.noise.sigma_range_m * options.noise.sigma_range_m;
  const double across = range_m * options.noise.sigma_bearing_rad;
  out.bearing_rad = std::atan2(d.y(), d.x());
  const Eigen::Vector2d u = d / range_m, v(-u.y(), u.x());
  out.measured = (sigma_range2 + options.sigma_bias_m * options.sigma_bias_m) * u * u.transpose() + across * across * v * v.transpose();
  if (!out.has_surface) return out;
  // Distance to the neighbouring samples on the surface, on both sides.
  const double incidence = std::asin(std::clamp(std::abs(point.n.dot(u)), 0.0, 1.0)), beta = options.radstep;
  const auto spread = [&](double angle) { return std::min(kLargestSpread_m, range_m * std::sin(beta) / std::max(std::sin(angle), 1e-3)); };
  const double farther = spread(std::max(incidence - beta, 0.0)), nearer = spread(incidence + beta);
  const double s2 = (std::pow(farther, 3) + std::pow(nearer, 3)) / (3 * (farther + nearer));
  const Eigen::Vector2d tangent(-point.n.y(), point.n.x());
  out.along = s2 * tangent * tangent.transpose();
  return out;
}

std::vector<NoisyPoint> noisy(const std::vector<OrientedPoint>& points, const Eigen::Vector2d& eye, const WeightedMatchOptions& options) {
  std::vector<NoisyPoint> out;
  for (const OrientedPoint& point : points) out.push_back(noisy(point, eye, options));
  return out;
}

/// Nearest point of the reference (sorted by bearing) within the gate, or none.
const NoisyPoint* nearest(const std::vector<NoisyPoint>& reference, const Eigen::Vector2d& eye, const Eigen::Vector2d& p, double gate_m) {
  const Eigen::Vector2d d = p - eye;
  const double bearing_rad = std::atan2(d.y(), d.x()), half_rad = std::min(1.0, gate_m / std::max(d.norm(), gate_m));
  auto k = std::lower_bound(reference.begin(), reference.end(), bearing_rad - half_rad,
                            [](const NoisyPoint& q, double limit) { return q.bearing_rad < limit; });
  const NoisyPoint* best = nullptr;
  double best_d2 = gate_m * gate_m;
  for (; k != reference.end() && k->bearing_rad < bearing_rad + half_rad; ++k)
    if (const double d2 = (k->p - p).squaredNorm(); d2 < best_d2) {
      best_d2 = d2;
      best = &*k;
    }
  return best;
}

/// Of old - R new: what both were measured wrong by, and that they need not be the same spot of the surface.
Eigen::Matrix2d pair_covariance(const NoisyPoint& old, const NoisyPoint& point, const Eigen::Matrix2d& R, const Eigen::Vector2d& e) {
  const Eigen::Matrix2d P = old.measured + R * point.measured * R.transpose() + kFloor2 * Eigen::Matrix2d::Identity();
  if (old.has_surface) return P + old.along;
  if (point.has_surface) return P + R * point.along * R.transpose();
  return P + e.squaredNorm() / 3 * Eigen::Matrix2d::Identity();
}

}  // namespace

WeightedMatchResult match_weighted(const Keyframe& reference, const std::vector<OrientedPoint>& points, const Eigen::Vector2d& eye_base,
                                   const Pose2& guess, const Eigen::Matrix3d& cov_guess, const WeightedMatchOptions& options) {
  std::vector<NoisyPoint> old_points = noisy(reference.points_base, reference.eye_base, options);
  std::sort(old_points.begin(), old_points.end(), [](const NoisyPoint& a, const NoisyPoint& b) { return a.bearing_rad < b.bearing_rad; });
  const std::vector<NoisyPoint> new_points = noisy(points, eye_base, options);
  WeightedMatchResult result;
  Pose2& T = result.T_reference_base = guess;
  double gate_m = options.gate_start_m;
  for (result.iterations = 1; result.iterations <= options.max_iterations; ++result.iterations) {
    const Eigen::Matrix2d R = rotation(T.heading);
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    double chi2 = 0;
    int pairs = 0;
    for (const NoisyPoint& point : new_points) {
      const Eigen::Vector2d Rp = R * point.p;
      const NoisyPoint* old = nearest(old_points, reference.eye_base, Rp + T.translation(), gate_m);
      if (!old) continue;
      const Eigen::Vector2d e = old->p - Rp - T.translation();
      const Eigen::Matrix2d P = pair_covariance(*old, point, R, e);
      Eigen::Matrix<double, 2, 3> A;
      A << -1, 0, Rp.y(), 0, -1, -Rp.x();
      if (e.dot((P + A * cov_guess * A.transpose()).inverse() * e) > kChi2_2dof_99) continue;
      const Eigen::Matrix2d W = P.inverse();
      H += A.transpose() * W * A;
      g += A.transpose() * W * e;
      chi2 += e.dot(W * e);
      ++pairs;
    }
    result.pairs = pairs;
    result.overlap = new_points.empty() ? 0 : static_cast<double>(pairs) / static_cast<double>(new_points.size());
    if (pairs < kFewestPairs) return result;
    result.information = H;
    result.chi2 = chi2 / (2 * pairs - 3);
    const Eigen::Vector3d step = -(H + 1e-9 * Eigen::Matrix3d::Identity()).ldlt().solve(g);
    T = {T.x + step[0], T.y + step[1], wrap_angle(T.heading + step[2])};
    result.converged = gate_m <= options.gate_end_m && step.head<2>().norm() < kStop_m && std::abs(step[2]) < kStop_rad;
    if (result.converged) break;
    gate_m = std::max(options.gate_end_m, kShrink * gate_m);
  }
  return result;
}

}  // namespace modslam
