// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/loop_detector.hpp"

#include <algorithm>
#include <cmath>

#include "common/graph/components.hpp"
#include "common/graph/relative_covariance.hpp"
#include "common/loops/place_match.hpp"

namespace modslam {
namespace {

constexpr double kPointSpacing_m = 0.04;
constexpr std::size_t kBeams = 60;
constexpr double kSigmas = 3.0;
constexpr double kFoundEvery_m = 2.0;  // way between two proposals of a robot that was carried away
constexpr std::size_t kFoundNodes = 12;

std::vector<Eigen::Vector2d> thin_out(const std::vector<OrientedPoint>& points, std::size_t most) {
  std::vector<Eigen::Vector2d> chosen;
  const std::size_t step = std::max<std::size_t>(1, points.size() / most);
  for (std::size_t i = 0; i < points.size(); i += step) chosen.push_back(points[i].p);
  return chosen;
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
  const std::vector<NodeId> parts = components(nodes_.size(), edges);
  if (parts.back() != 0) {  // the robot was carried away
    const std::optional<LoopProposal> found = find_in_other_parts(parts);
    return found ? std::vector<LoopProposal>{*found} : std::vector<LoopProposal>();
  }
  relocalizer_.reset();
  if (!wants_to_look()) return {};
  if (tree_stale_) rebuild_tree();
  std::vector<LoopProposal> proposals;
  std::vector<Candidate> candidates = visible_candidates(edges);
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(), [&](const Candidate& c) { return parts[static_cast<std::size_t>(c.id)] != 0; }),
                   candidates.end());
  const auto passes = split_into_passes(std::move(candidates));
  for (const auto& pass : passes) proposals.push_back(match(nodes_.back(), pass));
  if (!proposals.empty()) last_look_m_ = way_m_.back();
  return proposals;
}

/// Looks for the newest scans of a part of the graph in all that was there when the part began.
std::optional<LoopProposal> LoopDetector::find_in_other_parts(const std::vector<NodeId>& parts) {
  if (!relocalizer_ || relocalized_part_ != parts.back()) {
    relocalized_part_ = parts.back();
    relocalizer_.emplace(noise_.sigma_range_m, range_limit_m_);
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      if (parts[k] != parts.back()) relocalizer_->add_node(static_cast<NodeId>(k), nodes_[k]);
  }
  const Relocalizer::Answer answer = relocalizer_->look(nodes_.back());
  if (answer.verdict != Verdict::kOk || !answer.is_of_this_scan) return std::nullopt;
  if (way_m_.back() - last_look_m_ < kFoundEvery_m) return std::nullopt;
  last_look_m_ = way_m_.back();
  return match_at(answer.T_map_base, parts);
}

/// The newest node as if it stood at a place of another part, judged like any loop: two places that look alike to the eye that searches differ in
/// what a match can say.
std::optional<LoopProposal> LoopDetector::match_at(const Pose2& T_map_found, const std::vector<NodeId>& parts) const {
  std::vector<Candidate> near;
  const Eigen::Matrix3d cov = Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const double distance_m = distance(nodes_[k].T_map_base, T_map_found);
    if (parts[k] != parts.back() && distance_m < config_.close_m) near.push_back({static_cast<NodeId>(k), distance_m, cov});
  }
  if (near.empty()) return std::nullopt;
  std::stable_sort(near.begin(), near.end(), [](const Candidate& a, const Candidate& b) { return a.distance_m < b.distance_m; });
  if (near.size() > kFoundNodes) near.resize(kFoundNodes);
  Keyframe now = nodes_.back();
  now.T_map_base = T_map_found;
  LoopProposal proposal = match(now, near);
  if (proposal.verdict == Verdict::kDegenerate) proposal.verdict = Verdict::kAmbiguous;  // one corridor is like another
  return proposal;
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
  const RelativeCovariance bound(poses, edges, newest, ids);
  // Where the bound would have us search far afield, the exact covariance is worth its price.
  const bool unsure = std::any_of(ids.begin(), ids.end(), [&](NodeId id) { return kSigmas * position_sigma(bound[id]) > config_.close_m; });
  const std::vector<Eigen::Matrix3d> exact = unsure ? marginal_covariances(poses, edges, newest) : std::vector<Eigen::Matrix3d>();
  const Eigen::Vector2d eye = nodes_.back().eye_base;
  std::vector<Candidate> candidates;
  for (const QuadTree::Entry& entry : near) {
    const Eigen::Matrix3d& cov = unsure ? exact[static_cast<std::size_t>(entry.id)] : bound[entry.id];
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

LoopProposal LoopDetector::match(const Keyframe& now, const std::vector<Candidate>& pass) const {
  LoopProposal proposal;
  proposal.from = pass.front().id;
  proposal.to = static_cast<NodeId>(nodes_.size()) - 1;
  std::vector<const Keyframe*> affected;
  for (const Candidate& candidate : pass) {
    affected.push_back(&nodes_[static_cast<std::size_t>(candidate.id)]);
    proposal.affected.push_back(candidate.id);
  }
  const PlaceMatch match = match_place(now, affected, pass.front().cov, config_.limits());
  proposal.verdict = match.verdict;
  proposal.figures = match.figures;
  proposal.T_from_to = between(nodes_[static_cast<std::size_t>(proposal.from)].T_map_base, match.T_map_base);
  proposal.information = match.information;
  return proposal;
}

}  // namespace modslam
