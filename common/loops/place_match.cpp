// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/place_match.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kBlur_m = 0.08;
constexpr std::size_t kSearchPoints = 100;
constexpr double kMaxWindow_m = 7.0, kMaxWindow_rad = 0.7;
constexpr double kMaxFreeViolation = 0.25;
constexpr double kSigmas = 3.0;
constexpr double kWellKnown_m = 0.10, kFullOverlap = 0.75;
constexpr double kExpectedInnovation = 11.34;  // chi2, 3 degrees of freedom, 99 %
constexpr double kMaxSigma_m = 0.03;
constexpr double kMinShare = 0.02;  // of information: niches of a corridor look alike, and a few of their points fix nothing

std::vector<Eigen::Vector2d> search_points(const std::vector<OrientedPoint>& points) {
  std::vector<Eigen::Vector2d> chosen;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kSearchPoints);
  for (std::size_t i = 0; i < points.size(); i += step) chosen.push_back(points[i].p);
  return chosen;
}

SearchWindow window_for(const Eigen::Matrix3d& cov) {
  SearchWindow window;
  const double sigma_m = position_sigma(cov), sigma_rad = std::sqrt(cov(2, 2));
  window.half_m = std::clamp(kSigmas * sigma_m + 0.2, 0.3, kMaxWindow_m);
  window.half_rad = std::clamp(kSigmas * sigma_rad + 0.05, 0.1, kMaxWindow_rad);
  window.prior_sigma_m = sigma_m + 0.05;
  window.prior_sigma_rad = sigma_rad + 0.02;
  window.prior_weight = 0.01;
  return window;
}

double free_violation(const Keyframe& now, const Submap& map, const Pose2& T_map_base) {
  const PointMover to_map(T_map_base);
  const Eigen::Vector2d eye = to_map * now.eye_base;
  int tested = 0, blocked = 0;
  for (std::size_t i = 0; i < now.points_base.size(); i += 5, ++tested)
    blocked += map.is_blocked(eye, to_map * now.points_base[i].p, 0.3);
  return tested ? static_cast<double>(blocked) / tested : 0.0;
}

Verdict judge(const RefineResult& fit, const Observed& observed, const MatchFigures& figures, const PlaceLimits& limits) {
  if (figures.points < 20 || !fit.converged) return Verdict::kFailed;
  if (figures.overlap < limits.min_overlap) return Verdict::kLowOverlap;
  if (figures.chi2 > limits.max_chi2 || figures.free_violation > kMaxFreeViolation) return Verdict::kInconsistent;
  if (figures.ambiguity > limits.max_ambiguity) return Verdict::kAmbiguous;
  return observed.degenerate ? Verdict::kDegenerate : Verdict::kOk;
}

}  // namespace

double position_sigma(const Eigen::Matrix3d& cov) {
  const double half_trace = 0.5 * (cov(0, 0) + cov(1, 1)), spread = std::hypot(0.5 * (cov(0, 0) - cov(1, 1)), cov(0, 1));
  return std::sqrt(std::max(0.0, half_trace + spread));
}

PlaceMatch match_place(const Keyframe& now, const std::vector<const Keyframe*>& known, const Eigen::Matrix3d& cov, const PlaceLimits& limits) {
  const SearchWindow window = window_for(cov);
  Submap map;
  map.build(known, kBlur_m, window.half_m);
  RefineOptions options;
  options.gate_start_m = 0.3;
  const auto innovation = [&](const RefineResult& fit) {
    const Eigen::Vector3d d = between(now.T_map_base, fit.T_map_base).vector();
    const Eigen::Matrix3d slack = Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal();
    return d.dot((cov + slack).ldlt().solve(d));
  };
  PlaceMatch match;
  MatchFigures& f = match.figures;
  // Where the graph knows the way well and nearly all of the scan fits there, no other place is in question.
  RefineResult fit;
  const bool is_well_known = position_sigma(cov) < kWellKnown_m;
  if (is_well_known) fit = refine(now.points_base, map, now.T_map_base, options);
  f.score = fit.overlap;
  if (!is_well_known || !fit.converged || fit.overlap < kFullOverlap || innovation(fit) > kExpectedInnovation) {
    const SearchResult coarse =
        map.score_grid().search(search_points(now.points_base), now.T_map_base, window, limits.max_ambiguity - 0.02);
    fit = refine(now.points_base, map, coarse.T_map_base, options);
    f.score = coarse.score;
    f.ambiguity = coarse.score > 0 ? coarse.second_score / coarse.score : 1.0;
  }
  const Observed observed = observed_information(fit, kMaxSigma_m, kMinShare);
  f.overlap = fit.overlap;
  f.chi2 = fit.chi2;
  f.points = fit.pairs;
  f.iterations = fit.iterations;
  f.degenerate_rad = observed.degenerate_rad;
  f.free_violation = free_violation(now, map, fit.T_map_base);
  f.innovation = innovation(fit);
  match.verdict = judge(fit, observed, f, limits);
  match.T_map_base = fit.T_map_base;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(fit.T_map_base.heading);
  match.information = limits.information_scale * R.transpose() * observed.information * R;
  return match;
}

}  // namespace modslam
