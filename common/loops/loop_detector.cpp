// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/loop_detector.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/graph/relative_covariance.hpp"

namespace modslam {
namespace {

constexpr double kPointSpacing_m = 0.04;
constexpr double kBlur_m = 0.08;
constexpr std::size_t kSearchPoints = 100, kBeams = 60;
constexpr double kMaxWindow_m = 7.0, kMaxWindow_rad = 0.7;
constexpr double kMaxFreeViolation = 0.25;
constexpr double kSigmas = 3.0;
constexpr double kWellKnown_m = 0.10, kFullOverlap = 0.75;
constexpr double kExpectedInnovation = 11.34;  // chi2, 3 degrees of freedom, 99 %
constexpr double kMaxSigma_m = 0.03;
constexpr double kMinShare = 0.02;  // of information: niches of a corridor look alike, and a few of their points fix nothing

std::vector<Eigen::Vector2d> thin_out(const std::vector<OrientedPoint>& points, std::size_t most) {
  std::vector<Eigen::Vector2d> chosen;
  const std::size_t step = std::max<std::size_t>(1, points.size() / most);
  for (std::size_t i = 0; i < points.size(); i += step) chosen.push_back(points[i].p);
  return chosen;
}

double position_sigma(const Eigen::Matrix3d& cov) {
  const double half_trace = 0.5 * (cov(0, 0) + cov(1, 1)), spread = std::hypot(0.5 * (cov(0, 0) - cov(1, 1)), cov(0, 1));
  return std::sqrt(std::max(0.0, half_trace + spread));
}

}  // namespace

void LoopDetector::clear() { *this = LoopDetector(config_, noise_.sigma_range_m, range_limit_m_); }

void LoopDetector::add_node(NodeId id, const Pose2& T_map_base, const Scan& scan, const SensorInfo& sensor) {
  const double step_m = nodes_.empty() ? 0.0 : distance(nodes_.back().T_map_base, T_map_base);
  way_m_.push_back(way_m_.empty() ? 0.0 : way_m_.back() + step_m);
  nodes_.push_back({T_map_base, orient(scan, sensor, noise_, range_limit_m_, kPointSpacing_m),
                    sensor.T_base_laser.translation()});
  beams_base_.push_back(thin_out(nodes_.back().points_base, kBeams));
  insert_delayed_nodes();
  (void)id;
}

void LoopDetector::set_pose(NodeId id, const Pose2& T_map_base) {
  nodes_[static_cast<std::size_t>(id)].T_map_base = T_map_base;
  tree_stale_ = tree_stale_ || id < next_in_tree_;
}

void LoopDetector::insert_delayed_nodes() {
  while (next_in_tree_ < static_cast<NodeId>(nodes_.size()) &&
         way_m_.back() - way_m_[static_cast<std::size_t>(next_in_tree_)] > config_.delay_m) {
    tree_.insert(nodes_[static_cast<std::size_t>(next_in_tree_)].T_map_base.translation(), next_in_tree_);
    ++next_in_tree_;
  }
}

void LoopDetector::rebuild_tree() {
  tree_.clear();
  for (NodeId id = 0; id < next_in_tree_; ++id)
    tree_.insert(nodes_[static_cast<std::size_t>(id)].T_map_base.translation(), id);
  tree_stale_ = false;
}

std::vector<LoopProposal> LoopDetector::detect(const std::vector<const GraphEdge*>& edges) {
  if (!wants_to_look()) return {};
  if (tree_stale_) rebuild_tree();
  std::vector<LoopProposal> proposals;
  const auto passes = split_into_passes(visible_candidates(edges));
  for (const auto& pass : passes) proposals.push_back(match(pass));
  if (!proposals.empty()) last_look_m_ = way_m_.back();
  return proposals;
}

std::vector<LoopDetector::Candidate> LoopDetector::visible_candidates(
    const std::vector<const GraphEdge*>& edges) const {
  const NodeId newest = static_cast<NodeId>(nodes_.size()) - 1;
  const Pose2& T_map_new = nodes_.back().T_map_base;
  std::vector<QuadTree::Entry> near = tree_.near(T_map_new.translation(), config_.max_radius_m);
  if (near.empty()) return {};
  std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.id < b.id; });

  std::vector<Pose2> poses;
  for (const Keyframe& node : nodes_) poses.push_back(node.T_map_base);
  std::vector<NodeId> ids;
  for (const QuadTree::Entry& entry : near) ids.push_back(entry.id);
  const RelativeCovariance covariance(poses, edges, newest, ids);
  const Eigen::Vector2d eye = nodes_.back().eye_base;
  std::vector<Candidate> candidates;
  for (const QuadTree::Entry& entry : near) {
    const Eigen::Matrix3d& cov = covariance[entry.id];
    const double sigma_m = position_sigma(cov), d_m = (entry.p - T_map_new.translation()).norm();
    if (d_m > std::min(config_.max_radius_m, config_.close_m + kSigmas * sigma_m)) continue;
    // Beam test: the node must lie near a sample of some beam; behind a wall it does not.
    const double near_m = config_.beam_near_m + std::min(sigma_m, 2.0);
    const Eigen::Vector2d q = T_map_new.inverse() * entry.p - eye;
    const bool reached = d_m < near_m || std::any_of(beams_base_.back().begin(), beams_base_.back().end(),
                                                    [&](const Eigen::Vector2d& end) {
      const Eigen::Vector2d beam = end - eye;
      const double along = std::clamp(q.dot(beam) / beam.squaredNorm(), 0.0, 1.0);
      return (q - along * beam).squaredNorm() < near_m * near_m;
    });
    if (reached) candidates.push_back({entry.id, d_m, cov});
  }
  return candidates;
}

/// Groups candidates of one earlier visit; keeps the visits whose nearest node is nearest.
std::vector<std::vector<LoopDetector::Candidate>> LoopDetector::split_into_passes(
    std::vector<Candidate> candidates) const {
  std::vector<std::vector<Candidate>> passes;
  for (const Candidate& c : candidates) {
    const bool same = !passes.empty() && way_m_[static_cast<std::size_t>(c.id)] -
                                                 way_m_[static_cast<std::size_t>(passes.back().back().id)] <
                                             config_.pass_m;
    if (!same) passes.emplace_back();
    passes.back().push_back(c);
  }
  const auto nearest = [](const std::vector<Candidate>& pass) {
    return std::min_element(pass.begin(), pass.end(), [](const Candidate& a, const Candidate& b) {
      return a.distance_m < b.distance_m;
    });
  };
  std::stable_sort(passes.begin(), passes.end(), [&](const auto& a, const auto& b) {
    return nearest(a)->distance_m < nearest(b)->distance_m;
  });
  if (static_cast<std::int64_t>(passes.size()) > config_.passes) passes.resize(static_cast<std::size_t>(config_.passes));
  for (auto& pass : passes) {
    const Candidate centre = *nearest(pass);
    const double way_m = way_m_[static_cast<std::size_t>(centre.id)];
    pass.erase(std::remove_if(pass.begin(), pass.end(), [&](const Candidate& c) {
      return std::abs(way_m_[static_cast<std::size_t>(c.id)] - way_m) > config_.pass_m;
    }), pass.end());
    std::iter_swap(pass.begin(), std::find_if(pass.begin(), pass.end(), [&](const Candidate& c) { return c.id == centre.id; }));
  }
  return passes;
}

LoopProposal LoopDetector::match(const std::vector<Candidate>& pass) const {
  LoopProposal proposal;
  proposal.from = pass.front().id;
  proposal.to = static_cast<NodeId>(nodes_.size()) - 1;
  std::vector<const Keyframe*> affected;
  for (const Candidate& candidate : pass) {
    affected.push_back(&nodes_[static_cast<std::size_t>(candidate.id)]);
    proposal.affected.push_back(candidate.id);
  }
  const Keyframe& now = nodes_.back();
  const Eigen::Matrix3d& cov = pass.front().cov;
  SearchWindow window;
  window.half_m = std::clamp(kSigmas * position_sigma(cov) + 0.2, 0.3, kMaxWindow_m);
  window.half_rad = std::clamp(kSigmas * std::sqrt(cov(2, 2)) + 0.05, 0.1, kMaxWindow_rad);
  window.prior_sigma_m = position_sigma(cov) + 0.05;
  window.prior_sigma_rad = std::sqrt(cov(2, 2)) + 0.02;
  window.prior_weight = 0.01;
  Submap map;
  map.build(affected, kBlur_m, window.half_m);
  RefineOptions options;
  options.gate_start_m = 0.3;
  const auto innovation = [&](const RefineResult& fit) {
    const Eigen::Vector3d d = between(now.T_map_base, fit.T_map_base).vector();
    const Eigen::Matrix3d slack = Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal();
    return d.dot((cov + slack).ldlt().solve(d));
  };
  // Where the graph knows the way well and nearly all of the scan fits there, no other place is in question.
  MatchFigures& f = proposal.figures;
  RefineResult fit;
  const bool is_well_known = position_sigma(cov) < kWellKnown_m;
  if (is_well_known) fit = refine(now.points_base, map, now.T_map_base, options);
  f.score = fit.overlap;
  if (!is_well_known || !fit.converged || fit.overlap < kFullOverlap || innovation(fit) > kExpectedInnovation) {
    const SearchResult coarse =
        map.score_grid().search(thin_out(now.points_base, kSearchPoints), now.T_map_base, window, config_.max_ambiguity - 0.02);
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
  const PointMover to_map(fit.T_map_base);
  const Eigen::Vector2d eye = to_map * now.eye_base;
  int tested = 0, blocked = 0;
  for (std::size_t i = 0; i < now.points_base.size(); i += 5, ++tested)
    blocked += map.is_blocked(eye, to_map * now.points_base[i].p, 0.3);
  f.free_violation = tested ? static_cast<double>(blocked) / tested : 0.0;
  f.innovation = innovation(fit);

  proposal.verdict = observed.degenerate ? Verdict::kDegenerate : Verdict::kOk;
  if (f.points < 20 || !fit.converged) proposal.verdict = Verdict::kFailed;
  else if (f.overlap < config_.min_overlap) proposal.verdict = Verdict::kLowOverlap;
  else if (f.chi2 > config_.max_chi2 || f.free_violation > kMaxFreeViolation) proposal.verdict = Verdict::kInconsistent;
  else if (f.ambiguity > config_.max_ambiguity) proposal.verdict = Verdict::kAmbiguous;

  const Pose2& T_map_from = nodes_[static_cast<std::size_t>(proposal.from)].T_map_base;
  proposal.T_from_to = between(T_map_from, fit.T_map_base);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(fit.T_map_base.heading);
  proposal.information = config_.information_scale * R.transpose() * observed.information * R;
  return proposal;
}

}  // namespace modslam
