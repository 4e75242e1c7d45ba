// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/relocalizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "common/matching/point_to_line.hpp"

namespace modslam {
namespace {

constexpr double kPointSpacing_m = 0.05;
constexpr std::size_t kSearchPoints = 60, kJudgePoints = 150;
constexpr double kWideBlur_m = 0.5, kBlur_m = 0.12;
constexpr double kPlaceSpacing_m = 0.7;                 // between the places that are tried, all near where the map was made from
constexpr int kHeadings = 60;                           // tried at each
constexpr std::size_t kRough = 120;                     // guesses of the first sieve that are looked at closely
constexpr double kSpacing_m = 0.4, kSpacing_rad = 0.5;  // between two scans that are looked at
constexpr std::size_t kScans = 10;                      // kept since the robot got lost
constexpr double kShare = 0.80, kLeastScore = 0.40;     // of the best place's score: places that are kept
constexpr std::size_t kPlaces = 40;                     // found by one search
constexpr int kSearchEvery = 4;                         // scans: in between the hypotheses are only followed
constexpr double kSame_m = 0.4, kSame_rad = 0.25;       // two hypotheses this near are one
constexpr double kForgotten = 15;                       // log-likelihood behind the best at which a hypothesis is given up
constexpr double kIndependentPoints = 12;               // neighbouring beams err alike: a scan says as much as so many
constexpr double kOnWall = 0.9, kThroughWall = 0.02;    // probability of a point on a known wall where the robot is; of a beam through one
constexpr double kSurePosterior = 0.99, kSureOverlap = 0.7, kSureWorst = 0.5, kSureViolation = 0.10;
constexpr double kSureWay_m = 3.5;                      // driven since the first scan that is kept; a radian counts half a metre
constexpr std::size_t kSureScans = 6;
constexpr double kMapSpacing_m = 0.08;                  // of one node's points: the map is made of many

template <class Point>
std::vector<Point> thin_out(const std::vector<Point>& points, std::size_t most) {
  std::vector<Point> chosen;
  const std::size_t step = std::max<std::size_t>(1, points.size() / most);
  for (std::size_t k = 0; k < points.size(); k += step) chosen.push_back(points[k]);
  return chosen;
}

/// Drops what lies nearer than `spacing_m` to the last point kept. A scan is sparse far away and crowded near by.
std::vector<OrientedPoint> thin_out_by(const std::vector<OrientedPoint>& points, double spacing_m) {
  std::vector<OrientedPoint> chosen;
  for (const OrientedPoint& point : points)
    if (chosen.empty() || (chosen.back().p - point.p).norm() >= spacing_m) chosen.push_back(point);
  return chosen;
}

double apart(const Pose2& a, const Pose2& b, double m, double rad) {
  return std::max(distance(a, b) / m, std::abs(wrap_angle(a.heading - b.heading)) / rad);
}

}  // namespace

void Relocalizer::add_node(NodeId id, const Pose2& T_map_base, const Scan& scan, const SensorInfo& sensor) {
  add_node(id, {T_map_base, orient(scan, sensor, noise_, range_limit_m_, kPointSpacing_m), sensor.T_base_laser.translation()});
}

void Relocalizer::add_node(NodeId id, Keyframe node) {
  if (prepared_) throw std::logic_error("the map of a relocalizer is complete once it was asked");
  nodes_.push_back({node.T_map_base, thin_out_by(node.points_base, kMapSpacing_m), node.eye_base});
  ids_.push_back(id);
}

void Relocalizer::prepare() {
  if (prepared_) return;
  prepared_ = true;
  std::vector<const Keyframe*> all;
  std::vector<Eigen::Vector2d> walls;
  for (const Keyframe& node : nodes_) {
    all.push_back(&node);
    const PointMover to_map(node.T_map_base);
    for (const OrientedPoint& point : node.points_base) walls.push_back(to_map * point.p);
  }
  map_.build(all, kBlur_m, 1.0);
  wide_grid_.build(walls, kWideBlur_m, 0.2);
  grid_.build(walls, kBlur_m, kPlaceSpacing_m);
  for (Keyframe& node : nodes_) node.points_base = {};  // they are in the map now
  std::set<std::pair<int, int>> taken;
  for (const Keyframe& node : nodes_)
    for (const Eigen::Vector2d& aside : {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)}) {
      const Eigen::Vector2d place = node.T_map_base.translation() / kPlaceSpacing_m + aside;
      const std::pair<int, int> cell(static_cast<int>(std::lround(place.x())), static_cast<int>(std::lround(place.y())));
      if (taken.insert(cell).second) places_.emplace_back(cell.first * kPlaceSpacing_m, cell.second * kPlaceSpacing_m);
    }
}

void Relocalizer::forget() {
  seen_.clear();
  hypotheses_.clear();
  looks_ = 0;
  last_ = Answer();
}

Relocalizer::Answer Relocalizer::look(const Scan& scan, const SensorInfo& sensor, const Pose2& T_track_base) {
  if (!seen_.empty() && apart(seen_.back().T_track_base, T_track_base, kSpacing_m, kSpacing_rad) < 1) return stale();
  return look({T_track_base, orient(scan, sensor, noise_, range_limit_m_, kPointSpacing_m), sensor.T_base_laser.translation()});
}

Relocalizer::Answer Relocalizer::look(const Keyframe& scan) {
  prepare();
  if (!seen_.empty() && apart(seen_.back().T_track_base, scan.T_map_base, kSpacing_m, kSpacing_rad) < 1) return stale();
  Seen seen{scan.T_map_base, thin_out(scan.points_base, kJudgePoints), scan.eye_base};
  if (seen.points_base.size() < 20) return stale();
  seen_.push_back(std::move(seen));
  if (seen_.size() > kScans) seen_.pop_front();
  if (looks_++ % kSearchEvery == 0 || hypotheses_.empty() || hypotheses_.front().worst_overlap < kSureWorst) propose(seen_.back());
  for (Hypothesis& hypothesis : hypotheses_) judge(hypothesis);
  merge();
  return last_ = answer();
}

Relocalizer::Answer Relocalizer::stale() const {
  Answer answer = last_;
  answer.is_of_this_scan = false;
  return answer;
}

/// Adds the places where the newest scan alone could have been taken: a sieve over all places and headings on a blurred map, then a search
/// around what is left of them on a sharp one.
void Relocalizer::propose(const Seen& seen) {
  std::vector<Eigen::Vector2d> sparse;
  for (const OrientedPoint& point : thin_out(seen.points_base, kSearchPoints)) sparse.push_back(point.p);
  SearchWindow window;
  window.half_m = 0.8 * kPlaceSpacing_m;
  window.half_rad = 1.2 * kPi / kHeadings;
  std::vector<SearchResult> found;
  for (const Pose2& guess : rough_guesses(sparse)) found.push_back(grid_.search(sparse, guess, window));
  std::stable_sort(found.begin(), found.end(), [](const SearchResult& a, const SearchResult& b) { return a.score > b.score; });
  if (found.size() > kPlaces) found.resize(kPlaces);
  for (const SearchResult& place : found) {
    if (place.score < kLeastScore || place.score < kShare * found.front().score) break;
    Hypothesis hypothesis;
    hypothesis.T_map_track = place.T_map_base * seen.T_track_base.inverse();
    hypotheses_.push_back(hypothesis);
  }
}

/// The best poses on the blurred map that are no neighbours of each other.
std::vector<Pose2> Relocalizer::rough_guesses(const std::vector<Eigen::Vector2d>& points_base) const {
  struct Guess {
    double score;
    Pose2 T_map_base;
  };
  std::vector<Guess> guesses;
  for (const Eigen::Vector2d& place : places_)
    for (int k = 0; k < kHeadings; ++k) {
      const Pose2 T(place.x(), place.y(), wrap_angle(2 * kPi * k / kHeadings));
      guesses.push_back({wide_grid_.score(points_base, T), T});
    }
  std::stable_sort(guesses.begin(), guesses.end(), [](const Guess& a, const Guess& b) { return a.score > b.score; });
  std::vector<Pose2> out;
  for (const Guess& guess : guesses) {
    const bool known = std::any_of(out.begin(), out.end(), [&](const Pose2& T) { return apart(T, guess.T_map_base, 1.2 * kPlaceSpacing_m, 3.0 * kPi / kHeadings) < 1; });
    if (!known) out.push_back(guess.T_map_base);
    if (out.size() == kRough) break;
  }
  return out;
}

/// Lays the newest scan on the map and asks all scans what they think of that.
void Relocalizer::judge(Hypothesis& hypothesis) const {
  RefineOptions options;
  options.gate_start_m = 0.4;
  options.max_iterations = 8;
  const Seen& newest = seen_.back();
  hypothesis.fit = refine(newest.points_base, map_, hypothesis.T_map_track * newest.T_track_base, options);
  if (hypothesis.fit.pairs >= 10) hypothesis.T_map_track = hypothesis.fit.T_map_base * newest.T_track_base.inverse();
  hypothesis.log_likelihood = hypothesis.overlap = hypothesis.free_violation = 0;
  hypothesis.worst_overlap = 1;
  options.gate_start_m = 0.25;
  options.max_iterations = 2;  // what tracking and map are wrong by over the kept scans
  for (const Seen& seen : seen_) {
    const RefineResult fit = refine(seen.points_base, map_, hypothesis.T_map_track * seen.T_track_base, options);
    const double violation = free_violation(seen, fit.T_map_base);
    hypothesis.log_likelihood += kIndependentPoints * (fit.overlap * std::log(kOnWall) + (1 - fit.overlap) * std::log(1 - kOnWall) +
                                                       violation * std::log(kThroughWall));
    hypothesis.overlap += fit.overlap / static_cast<double>(seen_.size());
    hypothesis.free_violation += violation / static_cast<double>(seen_.size());
    hypothesis.worst_overlap = std::min(hypothesis.worst_overlap, fit.overlap);
  }
}

/// Best first; one of those that mean the same place, none that is hopeless.
void Relocalizer::merge() {
  std::stable_sort(hypotheses_.begin(), hypotheses_.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.log_likelihood > b.log_likelihood; });
  const Pose2& T_track_base = seen_.back().T_track_base;
  std::vector<Hypothesis> kept;
  for (const Hypothesis& h : hypotheses_) {
    if (!kept.empty() && kept.front().log_likelihood - h.log_likelihood > kForgotten) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Hypothesis& k) {
      return apart(k.T_map_track * T_track_base, h.T_map_track * T_track_base, kSame_m, kSame_rad) < 1;
    });
    if (!known) kept.push_back(h);
  }
  hypotheses_ = std::move(kept);
}

Relocalizer::Answer Relocalizer::answer() const {
  Answer answer;
  answer.scans = static_cast<int>(seen_.size());
  answer.hypotheses = static_cast<int>(hypotheses_.size());
  answer.verdict = Verdict::kFailed;
  if (hypotheses_.empty()) return answer;
  const Hypothesis& best = hypotheses_.front();
  double sum = 0;
  for (const Hypothesis& h : hypotheses_) sum += std::exp(h.log_likelihood - best.log_likelihood);
  answer.posterior = 1 / sum;
  answer.overlap = best.overlap;
  answer.T_map_base = best.T_map_track * seen_.back().T_track_base;
  answer.information = observed_information(best.fit).information;
  answer.nearest = nearest_node(answer.T_map_base);
  double way = 0;
  for (std::size_t k = 1; k < seen_.size(); ++k) way += apart(seen_[k - 1].T_track_base, seen_[k].T_track_base, 1.0, 2.0);
  if (best.overlap < kSureOverlap || best.worst_overlap < kSureWorst || best.free_violation > kSureViolation) return answer;
  answer.verdict = Verdict::kAmbiguous;
  if (answer.posterior > kSurePosterior && seen_.size() >= kSureScans && way >= kSureWay_m) answer.verdict = Verdict::kOk;
  return answer;
}

Relocalizer::Answer Relocalizer::locate(const Scan& scan, const SensorInfo& sensor, const Pose2& guess) {
  prepare();
  const Seen seen{{}, orient(scan, sensor, noise_, range_limit_m_, kPointSpacing_m), sensor.T_base_laser.translation()};
  RefineOptions options;
  options.gate_start_m = 0.3;
  const RefineResult fit = refine(seen.points_base, map_, guess, options);
  Answer answer;
  answer.T_map_base = fit.T_map_base;
  answer.overlap = fit.overlap;
  answer.scans = answer.hypotheses = 1;
  const Observed observed = observed_information(fit);
  answer.information = observed.information;
  answer.nearest = nearest_node(answer.T_map_base);
  const bool fits = fit.converged && fit.pairs >= 20 && fit.overlap >= kSureWorst && free_violation(seen, fit.T_map_base) <= 2 * kSureViolation;
  answer.verdict = !fits ? Verdict::kFailed : observed.degenerate ? Verdict::kDegenerate : Verdict::kOk;
  return answer;
}

double Relocalizer::free_violation(const Seen& seen, const Pose2& T_map_base) const {
  const PointMover to_map(T_map_base);
  const Eigen::Vector2d eye = to_map * seen.eye_base;
  int tested = 0, blocked = 0;
  for (std::size_t k = 0; k < seen.points_base.size(); k += 5, ++tested) blocked += map_.is_blocked(eye, to_map * seen.points_base[k].p, 0.4);
  return tested ? static_cast<double>(blocked) / tested : 0.0;
}

NodeId Relocalizer::nearest_node(const Pose2& T_map_base) const {
  NodeId nearest = -1;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    // A node that looked elsewhere shares less with the robot than one half a metre farther that looked the same way.
    const double d = distance(nodes_[k].T_map_base, T_map_base) + 0.3 * std::abs(wrap_angle(nodes_[k].T_map_base.heading - T_map_base.heading));
    if (d < best) best = d, nearest = ids_[k];
  }
  return nearest;
}

}  // namespace modslam
