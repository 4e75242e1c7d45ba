// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/scan_matcher.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/matching/weighted_match.hpp"

namespace modslam {
namespace {

constexpr double kPointSpacing_m = 0.03;
constexpr double kBlur_m = 0.06;              // of the correlative grid
constexpr int kSearchPoints = 120;            // used by the correlative search
constexpr double kWideWindow_m = 0.8, kWideWindow_rad = 0.9;  // second look at a doubtful match
constexpr double kSuspiciousInnovation = 16.27;               // chi2, 3 degrees of freedom, 99.9 %
constexpr double kExpectedInnovation = 11.34;                 // the same, 99 %
constexpr double kFullOverlap = 0.75;
constexpr double kCorridorRatio = 0.05;       // of the normals' moments: one direction hangs on a twentieth of the points
constexpr int kFailuresBeforeRestart = 8;     // scans in a row before the local map is given up

Eigen::Matrix3d rotate(const Eigen::Matrix3d& matrix, double angle_rad) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(angle_rad);
  return R * matrix * R.transpose();
}

std::vector<Eigen::Vector2d> thin_out(const std::vector<OrientedPoint>& points, std::size_t most) {
  std::vector<Eigen::Vector2d> chosen;
  const std::size_t step = std::max<std::size_t>(1, points.size() / most);
  for (std::size_t i = 0; i < points.size(); i += step) chosen.push_back(points[i].p);
  return chosen;
}

}  // namespace

std::vector<OrientedPoint> ScanMatcher::points_of(const Scan& scan, const SensorInfo& sensor) const {
  return orient(scan, sensor, {config_.sigma_range_m, 1e-3}, config_.range_limit_m, is_scan_to_scan() ? 0.0 : kPointSpacing_m);
}

void ScanMatcher::resume(const std::vector<PlacedScan>& local_map, const Pose2& T_track_base, int failures) {
  for (const PlacedScan& placed : local_map)
    add_keyframe({placed.T_track_base, points_of(placed.scan, placed.sensor), placed.sensor.T_base_laser.translation()});
  T_track_base_ = T_track_base;
  failures_ = failures;
  started_ = !local_map.empty();
}

ScanMatch ScanMatcher::match(const Scan& scan, const SensorInfo& sensor, const Pose2& motion) {
  const std::vector<OrientedPoint> points = points_of(scan, sensor);
  ScanMatch match;
  if (!started_) {
    started_ = true;
    match.verdict = Verdict::kFirst;
    update_submap(points, sensor, match);
    return match;
  }
  const Pose2 T_track_from = T_track_base_, guess = T_track_from * motion;
  const Eigen::Matrix3d cov_motion = odometry_covariance(motion, odometry_model_);
  const Eigen::Matrix3d cov_guess = rotate(cov_motion, T_track_from.heading);

  const Attempt best = is_scan_to_scan() ? scan_to_scan(points, sensor, std::abs(scan.radstep), guess, cov_guess)
                                         : best_attempt(points, sensor, motion, guess, cov_guess);
  match.verdict = best.verdict;
  match.figures = best.figures;
  Eigen::Matrix3d information_map = Eigen::Matrix3d::Zero();
  match.T_track_base = guess;
  if (is_usable(best.verdict)) {
    match.T_track_base = best.fit.T_map_base;
    // A match errs against the local map, and that error comes once a keyframe, not once a scan: scans of a robot that
    // hardly moves repeat it.
    const double share = std::clamp(std::hypot(motion.x, motion.y) / config_.keyframe_m +
                                        std::abs(motion.heading) / config_.keyframe_rad, 0.02, 1.0);
    information_map = (is_scan_to_scan() ? 1.0 : config_.information_scale / share) * best.observed.information;
  }
  match.T_from_to = between(T_track_from, match.T_track_base);
  match.information = rotate(information_map, -T_track_from.heading);
  match.covariance = (match.information + cov_motion.inverse()).inverse();
  T_track_base_ = match.T_track_base;
  failures_ = is_usable(best.verdict) ? 0 : failures_ + 1;
  update_submap(points, sensor, match);
  return match;
}

/// First the refinement alone, from the odometry: it needs no search where the odometry is as good as it claims and the whole scan fits.
/// Else the search in a window as wide as the odometry may be wrong, and for an answer in doubt a wide one.
ScanMatcher::Attempt ScanMatcher::best_attempt(const std::vector<OrientedPoint>& points, const SensorInfo& sensor, const Pose2& motion,
                                               const Pose2& guess, const Eigen::Matrix3d& cov_guess) const {
  Attempt best = refine_from(points, sensor, guess, guess, cov_guess);
  if (is_usable(best.verdict) && best.figures.overlap > kFullOverlap && best.figures.innovation < kExpectedInnovation) return best;
  const std::vector<Eigen::Vector2d> sparse = thin_out(points, kSearchPoints);
  SearchWindow window;
  window.half_m = config_.window_m + 2.2 * std::hypot(motion.x, motion.y);
  window.half_rad = config_.window_rad + 0.5 * std::abs(motion.heading);
  window.prior_sigma_m = std::sqrt(cov_guess.topLeftCorner<2, 2>().trace() / 2) + 0.02;
  window.prior_sigma_rad = std::sqrt(cov_guess(2, 2)) + 0.01;
  window.prior_weight = 0.002;
  best = refine_from(points, sensor, submap_.score_grid().search(sparse, guess, window).T_map_base, guess, cov_guess);
  if (is_usable(best.verdict)) return best;
  // Whoever looks again does not trust the guess: it only decides between places that fit alike.
  window.prior_sigma_m = window.half_m = std::max(window.half_m, kWideWindow_m);
  window.prior_sigma_rad = window.half_rad = std::max(window.half_rad, kWideWindow_rad);
  const Attempt wide = refine_from(points, sensor, submap_.score_grid().search(sparse, guess, window).T_map_base, guess, cov_guess);
  return is_usable(wide.verdict) || wide.figures.overlap > best.figures.overlap ? wide : best;
}

ScanMatcher::Attempt ScanMatcher::refine_from(const std::vector<OrientedPoint>& points, const SensorInfo& sensor, const Pose2& start,
                                              const Pose2& guess, const Eigen::Matrix3d& cov_guess) const {
  Attempt attempt;
  RefineOptions options;
  options.gate_start_m = 0.25;
  options.prior_information = cov_guess.inverse();
  attempt.fit = refine(points, submap_, start, options);
  Eigen::Vector3d from_guess = attempt.fit.T_map_base.vector() - guess.vector();
  from_guess[2] = wrap_angle(from_guess[2]);
  attempt.figures.innovation = from_guess.dot(cov_guess.ldlt().solve(from_guess));
  attempt.observed = observed_information(attempt.fit);
  // Where the scan says nothing the guess stands, whatever the search happened to like there.
  Pose2& T = attempt.fit.T_map_base;
  Eigen::Vector3d to_guess = guess.vector() - T.vector();
  to_guess[2] = wrap_angle(to_guess[2]);
  const Eigen::Vector3d back = attempt.observed.unobserved * to_guess;
  T = {T.x + back[0], T.y + back[1], wrap_angle(T.heading + back[2])};
  ask_landmarks(points, cov_guess, attempt);

  MatchFigures& figures = attempt.figures;
  figures.overlap = attempt.fit.overlap;
  figures.chi2 = attempt.fit.chi2;
  figures.normal_ratio = attempt.fit.normal_ratio;
  figures.degenerate_rad = attempt.observed.degenerate_rad;
  figures.points = attempt.fit.pairs;
  figures.iterations = attempt.fit.iterations;
  figures.free_violation = free_violation(points, sensor, attempt.fit.T_map_base);
  attempt.verdict = judge(attempt);
  return attempt;
}

/// A corridor's surfaces say nothing of the way along it; the small things in it may.
void ScanMatcher::ask_landmarks(const std::vector<OrientedPoint>& points, const Eigen::Matrix3d& cov_guess, Attempt& attempt) const {
  Observed& observed = attempt.observed;
  if (!observed.lacks_one_translation()) return;
  if (!landmarks_ready_) landmarks_.build(keyframe_pointers());
  landmarks_ready_ = true;
  const Eigen::Vector2d along(std::cos(observed.degenerate_rad), std::sin(observed.degenerate_rad));
  Pose2& T = attempt.fit.T_map_base;
  const LandmarkFit fit = fit_along(points, landmarks_, T, along, std::sqrt(along.dot(cov_guess.topLeftCorner<2, 2>() * along)));
  T = {T.x + fit.shift_m * along.x(), T.y + fit.shift_m * along.y(), T.heading};
  observed.information.topLeftCorner<2, 2>() += fit.information * along * along.transpose();
}

/// The only failures that the thesis's matcher knows: too few pairs, and no end.
ScanMatcher::Attempt ScanMatcher::scan_to_scan(const std::vector<OrientedPoint>& points, const SensorInfo& sensor, double radstep,
                                               const Pose2& guess, const Eigen::Matrix3d& cov_guess) const {
  const Keyframe& reference = keyframes_.back();
  WeightedMatchOptions options;
  options.noise = {config_.sigma_range_m, 1e-3};
  options.radstep = radstep;
  const WeightedMatchResult fit =
      match_weighted(reference, points, sensor.T_base_laser.translation(), between(reference.T_map_base, guess),
                     rotate(cov_guess, -reference.T_map_base.heading), options);
  Attempt attempt;
  attempt.fit.T_map_base = reference.T_map_base * fit.T_reference_base;
  attempt.observed.information = rotate(fit.information, reference.T_map_base.heading);
  attempt.figures.overlap = fit.overlap;
  attempt.figures.chi2 = fit.chi2;
  attempt.figures.points = fit.pairs;
  attempt.figures.iterations = fit.iterations;
  attempt.verdict = fit.converged ? Verdict::kOk : Verdict::kFailed;
  return attempt;
}

Verdict ScanMatcher::judge(const Attempt& attempt) const {
  const MatchFigures& f = attempt.figures;
  if (f.points < 10 || !attempt.fit.converged) return Verdict::kFailed;
  if (f.overlap < config_.min_overlap) return Verdict::kLowOverlap;
  if (f.chi2 > config_.max_chi2) return Verdict::kInconsistent;
  // People and chairs move: a few crossed surfaces are excused when nearly all of the scan is in the map.
  if (f.free_violation > config_.max_free_violation * (f.overlap > kFullOverlap ? 2 : 1)) return Verdict::kInconsistent;
  // Odometry and laser disagree: the laser is believed only where many surfaces speak for it and it fits well.
  const bool fits_badly = f.overlap < 0.5 * (1 + config_.min_overlap);
  if (f.innovation > kSuspiciousInnovation && (attempt.observed.degenerate ? fits_badly : f.normal_ratio < kCorridorRatio))
    return Verdict::kInconsistent;
  return attempt.observed.degenerate ? Verdict::kDegenerate : Verdict::kOk;
}

double ScanMatcher::free_violation(const std::vector<OrientedPoint>& points, const SensorInfo& sensor,
                                   const Pose2& T) const {
  const PointMover to_map(T);
  const Eigen::Vector2d eye = to_map * sensor.T_base_laser.translation();
  int tested = 0, blocked = 0;
  for (std::size_t i = 0; i < points.size(); i += 5) {
    ++tested;
    blocked += submap_.is_blocked(eye, to_map * points[i].p, 0.3);
  }
  return tested ? static_cast<double>(blocked) / tested : 0.0;
}

void ScanMatcher::update_submap(const std::vector<OrientedPoint>& points, const SensorInfo& sensor,
                                const ScanMatch& match) {
  if (is_scan_to_scan()) {
    keyframes_.assign(1, {match.T_track_base, points, sensor.T_base_laser.translation()});
    return;
  }
  const bool lost = failures_ >= kFailuresBeforeRestart;
  if (!keyframes_.empty() && !lost) {
    if (!is_usable(match.verdict)) return;
    const Pose2 since = between(keyframes_.back().T_map_base, match.T_track_base);
    if (std::hypot(since.x, since.y) < config_.keyframe_m && std::abs(since.heading) < config_.keyframe_rad) return;
  }
  if (lost) {
    keyframes_.clear();  // nothing in it can be recognised any more: a new piece of map begins here
    failures_ = 0;
  }
  add_keyframe({match.T_track_base, points, sensor.T_base_laser.translation()});
}

void ScanMatcher::add_keyframe(Keyframe keyframe) {
  ++joined_;
  keyframes_.push_back(std::move(keyframe));
  while (static_cast<std::int64_t>(keyframes_.size()) > config_.keyframes) keyframes_.pop_front();
  submap_.build(keyframe_pointers(), kBlur_m, kWideWindow_m);
  landmarks_ready_ = false;
}

std::vector<const Keyframe*> ScanMatcher::keyframe_pointers() const {
  std::vector<const Keyframe*> all;
  for (const Keyframe& keyframe : keyframes_) all.push_back(&keyframe);
  return all;
}

}  // namespace modslam
