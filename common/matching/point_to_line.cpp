// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/point_to_line.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kMinCosine = 0.90;  // normals of partners agree to about 25 degrees
constexpr double kStop_m = 1e-4, kStop_rad = 2e-5;
constexpr double kSettled_m = 3e-3, kSettled_rad = 1e-3;  // partners still change, the pose hardly does
constexpr int kDampAfter = 10;                            // iterations; then flickering partners are damped

struct Normal {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero(), S = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  Eigen::Matrix2d normals = Eigen::Matrix2d::Zero(), normals_seen = normals, normals_matched = normals;
  double chi2 = 0;
  int pairs = 0, near = 0, candidates = 0;
};

/// Sums the normal equations at a pose; `last` also counts the inliers and the spurious information.
Normal accumulate(const std::vector<OrientedPoint>& points, const SurfaceSource& map, const Pose2& T, double gate_m,
                  const RefineOptions& options, bool last) {
  Normal sum;
  const Eigen::Matrix2d R = rotation(T.heading);
  const double model2 = options.model_sigma_m * options.model_sigma_m;
  for (const OrientedPoint& point : points) {
    if (!point.has_normal()) continue;
    ++sum.candidates;
    const Eigen::Vector2d Rp = R * point.p, p = Rp + T.translation(), n_point = R * point.n;
    if (last) sum.normals_seen += n_point * n_point.transpose();
    Surface surface;
    if (!map.nearest_surface(p, n_point, gate_m, kMinCosine, surface)) continue;
    const double e = surface.n.dot(surface.p - p);
    const double v = point.var_m2 + surface.var_m2 + model2;
    const double ratio = e / options.robust_m;
    const double weight = 1.0 / (v * (1.0 + ratio * ratio));
    // d(n'(q - Rp - t)) = -n' dt - n' J Rp dheading
    const Eigen::Vector3d a(-surface.n.x(), -surface.n.y(), surface.n.x() * Rp.y() - surface.n.y() * Rp.x());
    sum.H += weight * a * a.transpose();
    sum.g += weight * e * a;
    ++sum.pairs;
    if (std::abs(e) < options.gate_end_m) ++sum.near;
    if (last) {
      sum.chi2 += e * e / v;
      sum.normals += surface.n * surface.n.transpose();
      if (std::abs(e) < 0.5 * options.gate_end_m) sum.normals_matched += n_point * n_point.transpose();
      const Eigen::Vector2d t(-surface.n.y(), surface.n.x());
      const Eigen::Vector3d b(-t.x(), -t.y(), t.x() * Rp.y() - t.y() * Rp.x());
      sum.S += weight * (double{point.var_normal_rad2} / std::max(1, surface.count) + surface.var_normal_rad2) * b * b.transpose();
    }
  }
  return sum;
}

}  // namespace

RefineResult refine(const std::vector<OrientedPoint>& points, const SurfaceSource& map, const Pose2& guess,
                    const RefineOptions& options) {
  RefineResult result;
  Pose2 T = guess;
  for (int k = 0; k < options.max_iterations; ++k) {
    const double shrink = std::pow(0.6, k);
    const double gate_m = std::max(options.gate_end_m, options.gate_start_m * shrink);
    const Normal sum = accumulate(points, map, T, gate_m, options, false);
    result.iterations = k + 1;
    if (sum.pairs < 5) break;
    Eigen::Vector3d from_guess = T.vector() - guess.vector();
    from_guess[2] = wrap_angle(from_guess[2]);
    // The prior keeps directions in place that the points say nothing about.
    const Eigen::Matrix3d H = sum.H + options.prior_information + 1e-6 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d g = sum.g + options.prior_information * from_guess;
    Eigen::Vector3d step = -H.ldlt().solve(g);
    if (k >= kDampAfter) step *= 0.5;
    T = {T.x + step[0], T.y + step[1], wrap_angle(T.heading + step[2])};
    if (gate_m > options.gate_end_m) continue;
    result.converged = step.head<2>().norm() < kSettled_m && std::abs(step[2]) < kSettled_rad;
    if (step.head<2>().norm() < kStop_m && std::abs(step[2]) < kStop_rad) break;
  }
  const Normal sum = accumulate(points, map, T, options.gate_end_m, options, true);
  result.T_map_base = T;
  result.pairs = sum.pairs;
  result.overlap = sum.candidates ? static_cast<double>(sum.near) / sum.candidates : 0.0;
  result.chi2 = sum.pairs > 3 ? sum.chi2 / (sum.pairs - 3) : 0.0;
  result.spurious = sum.S;
  result.information = sum.H;
  result.normals_seen = sum.normals_seen;
  result.normals_matched = sum.normals_matched;
  const double half_trace = 0.5 * sum.normals.trace(),
               spread = std::hypot(0.5 * (sum.normals(0, 0) - sum.normals(1, 1)), sum.normals(0, 1));
  result.normal_ratio = half_trace + spread > 0 ? (half_trace - spread) / (half_trace + spread) : 0.0;
  return result;
}

}  // namespace modslam
