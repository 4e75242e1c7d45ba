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
constexpr double kKeep_m = 1e-3, kKeep_rad = 3e-4;        // below this step no point changes its partner any more
constexpr int kDampAfter = 10;                            // iterations; then flickering partners are damped

struct Normal {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
};

/// A point and the surface that it was last seen to lie on.
struct Pair {
  const OrientedPoint* point;
  Surface surface;
};

/// The points that have a partner at a pose.
void find_pairs(const std::vector<OrientedPoint>& points, const SurfaceSource& map, const Pose2& T, double gate_m, std::vector<Pair>& pairs) {
  pairs.clear();
  const Eigen::Matrix2d R = rotation(T.heading);
  for (const OrientedPoint& point : points) {
    if (!point.has_normal()) continue;
    Pair pair{&point, {}};
    if (map.nearest_surface(R * point.p + T.translation(), R * point.n, gate_m, kMinCosine, pair.surface)) pairs.push_back(pair);
  }
}

/// Residual of a pair and what it weighs.
struct Residual {
  Residual(const Pair& pair, const Eigen::Vector2d& Rp, const Pose2& T, const RefineOptions& options)
      : e(pair.surface.n.dot(pair.surface.p - Rp - T.translation())),
        v(pair.point->var_m2 + pair.surface.var_m2 + options.model_sigma_m * options.model_sigma_m) {
    const double ratio = e / options.robust_m;
    weight = 1.0 / (v * (1.0 + ratio * ratio));
  }
  double e, v, weight;
};

/// d(n' (q - R p - t)) = -n' dt - n' J R p dheading
Eigen::Vector3d jacobian(const Eigen::Vector2d& n, const Eigen::Vector2d& Rp) {
  return {-n.x(), -n.y(), n.x() * Rp.y() - n.y() * Rp.x()};
}

/// Adds weight a a' to the upper triangle.
void add_outer(Eigen::Matrix3d& sum, double weight, const Eigen::Vector3d& a) {
  for (int row = 0; row < 3; ++row)
    for (int column = row; column < 3; ++column) sum(row, column) += weight * a[row] * a[column];
}

Normal accumulate(const std::vector<Pair>& pairs, const Pose2& T, const RefineOptions& options) {
  Normal sum;
  const Eigen::Matrix2d R = rotation(T.heading);
  for (const Pair& pair : pairs) {
    const Eigen::Vector2d Rp = R * pair.point->p;
    const Residual residual(pair, Rp, T, options);
    const Eigen::Vector3d a = jacobian(pair.surface.n, Rp);
    add_outer(sum.H, residual.weight, a);
    sum.g += residual.weight * residual.e * a;
  }
  sum.H = sum.H.selfadjointView<Eigen::Upper>();
  return sum;
}

/// What the answer is judged by: inliers, spurious information, which way surfaces face.
struct Account {
  Eigen::Matrix3d S = Eigen::Matrix3d::Zero();
  Eigen::Matrix2d normals = Eigen::Matrix2d::Zero(), normals_seen = normals, normals_matched = normals;
  double chi2 = 0;
  int near = 0, candidates = 0;
};

Account give_account(const std::vector<OrientedPoint>& points, const std::vector<Pair>& pairs, const Pose2& T, const RefineOptions& options) {
  Account sum;
  const Eigen::Matrix2d R = rotation(T.heading);
  for (const OrientedPoint& point : points) {
    if (!point.has_normal()) continue;
    ++sum.candidates;
    const Eigen::Vector2d n = R * point.n;
    sum.normals_seen += n * n.transpose();
  }
  for (const Pair& pair : pairs) {
    const OrientedPoint& point = *pair.point;
    const Surface& surface = pair.surface;
    const Eigen::Vector2d Rp = R * point.p, n_point = R * point.n, t(-surface.n.y(), surface.n.x());
    const Residual residual(pair, Rp, T, options);
    sum.near += std::abs(residual.e) < options.gate_end_m;
    sum.chi2 += residual.e * residual.e / residual.v;
    sum.normals += surface.n * surface.n.transpose();
    if (std::abs(residual.e) < 0.5 * options.gate_end_m) sum.normals_matched += n_point * n_point.transpose();
    add_outer(sum.S, residual.weight * (double{point.var_normal_rad2} / std::max(1, surface.count) + surface.var_normal_rad2), jacobian(t, Rp));
  }
  sum.S = sum.S.selfadjointView<Eigen::Upper>();
  return sum;
}

}  // namespace

RefineResult refine(const std::vector<OrientedPoint>& points, const SurfaceSource& map, const Pose2& guess,
                    const RefineOptions& options) {
  RefineResult result;
  Pose2 T = guess;
  std::vector<Pair> pairs;
  pairs.reserve(points.size());
  bool settled = false;  // the partners are those of the end
  for (int k = 0; k < options.max_iterations; ++k) {
    const double gate_m = std::max(options.gate_end_m, options.gate_start_m * std::pow(0.6, k));
    if (!settled) find_pairs(points, map, T, gate_m, pairs);
    const Normal sum = accumulate(pairs, T, options);
    result.iterations = k + 1;
    if (pairs.size() < 5) break;
    Eigen::Vector3d from_guess = T.vector() - guess.vector();
    from_guess[2] = wrap_angle(from_guess[2]);
    // The prior keeps directions in place that the points say nothing about.
    const Eigen::Matrix3d H = sum.H + options.prior_information + 1e-6 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d g = sum.g + options.prior_information * from_guess;
    Eigen::Vector3d step = -H.ldlt().solve(g);
    if (k >= kDampAfter) step *= 0.5;
    T = {T.x + step[0], T.y + step[1], wrap_angle(T.heading + step[2])};
    if (gate_m > options.gate_end_m) continue;
    const double step_m = step.head<2>().norm(), step_rad = std::abs(step[2]);
    result.converged = step_m < kSettled_m && step_rad < kSettled_rad;
    settled = step_m < kKeep_m && step_rad < kKeep_rad;
    if (step_m < kStop_m && step_rad < kStop_rad) break;
  }
  if (!settled) find_pairs(points, map, T, options.gate_end_m, pairs);
  const Account account = give_account(points, pairs, T, options);
  result.T_map_base = T;
  result.pairs = static_cast<int>(pairs.size());
  result.overlap = account.candidates ? static_cast<double>(account.near) / account.candidates : 0.0;
  result.chi2 = result.pairs > 3 ? account.chi2 / (result.pairs - 3) : 0.0;
  result.spurious = account.S;
  result.information = accumulate(pairs, T, options).H;
  result.normals_seen = account.normals_seen;
  result.normals_matched = account.normals_matched;
  const double half_trace = 0.5 * account.normals.trace(),
               spread = std::hypot(0.5 * (account.normals(0, 0) - account.normals(1, 1)), account.normals(0, 1));
  result.normal_ratio = half_trace + spread > 0 ? (half_trace - spread) / (half_trace + spread) : 0.0;
  return result;
}

}  // namespace modslam
