// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/estimator.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/graph/components.hpp"
#include "common/graph/relative_covariance.hpp"

namespace modslam {
namespace {

constexpr double kChi2_3dof_999 = 16.27, kChi2_3dof_99 = 11.34;
constexpr std::size_t kMaxWaiting = 30;
constexpr double kApart_m = 30;                // between the map and what a robot sees that was carried away
constexpr double kUrgentChi2 = 6.0;          // a loop that pulls harder than this is optimised at once
constexpr double kUnseen = 1e-2;             // information filled in where a loop saw nothing: 10 m

GraphEdge to_edge(const LoopProposal& loop) {
  return {0, loop.from, loop.to, EdgeKind::kLoop, loop.T_from_to, loop.information};
}

/// Covariance of a loop's measurement, additive, frame of its old node.
Eigen::Matrix3d loop_covariance(const LoopProposal& loop) {
  GraphEdge edge;
  edge.T_from_to = loop.T_from_to;
  edge.information = loop.information + kUnseen * Eigen::Matrix3d::Identity();
  return edge_covariance_from(edge);
}

}  // namespace

GraphEstimator::Step GraphEstimator::move(const std::vector<MotionMeasurement>& measurements, const Localize& localize, bool may_be_node) {
  Step step;
  if (graph_.poses.empty()) {
    graph_.poses.emplace_back();
    published_poses_.emplace_back();
    step.is_new_node = true;
  } else if (!measurements.empty()) {
    const Proposal proposal = fuse(measurements);
    const Pose2 T_from_to = config_.proposal == "sampled" ? sample(proposal, random_) : proposal.T_from_to;
    robot_.covariance = compose_covariance(robot_.T_node_base, robot_.covariance, T_from_to, proposal.covariance);
    robot_.T_node_base = robot_.T_node_base * T_from_to;
    T_step_base_ = T_step_base_ * T_from_to;
    if (may_be_node && (std::hypot(T_step_base_.x, T_step_base_.y) >= config_.node_m || std::abs(T_step_base_.heading) >= config_.node_rad)) {
      T_step_base_ = Pose2();
      const Anchorage before = robot_;
      step.is_new_node = !stay_in_known_space(localize);
      if (step.is_new_node) append_node();
      if (robot_.node != before.node || robot_.T_node_base.vector() != before.T_node_base.vector()) {
        step.node_before = before.node;
        step.T_before_base = before.T_node_base;
      }
    }
  }
  const Step here = step_here();
  step.T_map_base = here.T_map_base;
  step.covariance = here.covariance;
  step.node = here.node;
  step.T_node_base = here.T_node_base;
  return step;
}

GraphEstimator::Step GraphEstimator::step_here() const {
  Step step;
  step.T_map_base = graph_.poses[static_cast<std::size_t>(robot_.node)] * robot_.T_node_base;
  step.covariance = robot_.covariance;
  step.node = robot_.node;
  step.T_node_base = robot_.T_node_base;
  return step;
}

GraphEstimator::Step GraphEstimator::begin_apart() {
  const Pose2& T_map_last = graph_.poses[static_cast<std::size_t>(robot_.node)];
  const auto rightmost = std::max_element(graph_.poses.begin(), graph_.poses.end(), [](const Pose2& a, const Pose2& b) { return a.x < b.x; });
  const Pose2 T_map_apart(rightmost->x + kApart_m, T_map_last.y, T_map_last.heading);
  append_node({0, robot_.node, 0, EdgeKind::kSequence, between(T_map_last, T_map_apart), break_information()}, T_map_apart);
  Step step = step_here();
  step.is_new_node = true;
  return step;
}

NodeId GraphEstimator::part_of_robot() const {
  if (std::none_of(graph_.edges.begin(), graph_.edges.end(), is_break)) return 0;
  return components(graph_.poses.size(), edges())[static_cast<std::size_t>(robot_.node)];
}

void GraphEstimator::append_node() {
  GraphEdge edge;
  edge.from = robot_.node;
  edge.T_from_to = robot_.T_node_base;
  // A millimetre and a third of a milliradian is as good as any step is known.
  const Eigen::Matrix3d floor = Eigen::Vector3d(1e-6, 1e-6, 1e-7).asDiagonal();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(robot_.T_node_base.heading);
  edge.information = R.transpose() * (robot_.covariance + floor).inverse() * R;
  edge.information = 0.5 * (edge.information + edge.information.transpose()).eval();
  append_node(edge, graph_.poses[static_cast<std::size_t>(robot_.node)] * robot_.T_node_base);
}

/// The robot stands on the new node; the edge gets its number and its far end.
void GraphEstimator::append_node(const GraphEdge& to_it, const Pose2& T_map_node) {
  GraphEdge edge = to_it;
  edge.id = next_edge_++;
  edge.to = static_cast<NodeId>(graph_.poses.size());
  graph_.poses.push_back(T_map_node);
  published_poses_.push_back(T_map_node);
  graph_.edges.push_back(edge);
  changes_.added.push_back(edge);
  robot_ = {edge.to, {}, Eigen::Matrix3d::Zero()};
  T_step_base_ = Pose2();
}

/// Where the place is full, hangs the robot on an old node. A scan that does not fit there makes a node after all, until the place holds twice
/// as many; then the robot goes on from where it hangs.
bool GraphEstimator::stay_in_known_space(const Localize& localize) {
  if (config_.full_at == 0 || !localize) return false;
  const Pose2 T_map_base = graph_.poses[static_cast<std::size_t>(robot_.node)] * robot_.T_node_base;
  const std::vector<NodeId> known = nodes_in_reach(graph_.poses, T_map_base);
  const auto most = static_cast<std::size_t>(config_.full_at);
  if (known.size() < most) return false;
  const Anchorage expected = seen_from(known.front());
  // Who comes here by a way that the graph knows badly closes a loop, and loops are judged elsewhere.
  if (position_sigma(expected.covariance) - position_sigma(robot_.covariance) > config_.trusted_sigma_m) return false;
  const Localized answer = localize(known, expected);
  const std::optional<AnchorFix>& fix = answer.fix;
  const std::optional<Anchorage> place = fix ? combine(expected, *fix) : std::nullopt;
  if (!place) return answer.shows_nothing_new || known.size() >= 2 * most;
  const Anchorage came = std::exchange(robot_, *place);
  ++reused_;
  if (came.node == place->node) return true;
  const GraphEdge edge = passing_edge(came, place->node, *fix);
  if (is_news(edge)) accept(edge);
  return true;
}

/// The robot relative to another node than the one that it hangs on.
Anchorage GraphEstimator::seen_from(NodeId node) const {
  if (node == robot_.node) return robot_;
  const Pose2 T_node_hung = between(graph_.poses[static_cast<std::size_t>(node)], graph_.poses[static_cast<std::size_t>(robot_.node)]);
  const Eigen::Matrix3d cov_hung = RelativeCovariance(graph_.poses, edges(), node, {robot_.node})[robot_.node];
  return {node, T_node_hung * robot_.T_node_base, compose_covariance(T_node_hung, cov_hung, robot_.T_node_base, robot_.covariance)};
}

/// Whether an edge is clearly surer than what the graph knows of its ends already.
bool GraphEstimator::is_news(const GraphEdge& edge) const {
  const Eigen::Matrix3d known = RelativeCovariance(graph_.poses, edges(), edge.from, {edge.to})[edge.to];
  return position_sigma(known) > 1.2 * position_sigma(edge_covariance_from(edge));
}

std::vector<const GraphEdge*> GraphEstimator::edges() const {
  std::vector<const GraphEdge*> out;
  for (const GraphEdge& edge : graph_.edges) out.push_back(&edge);
  return out;
}

void GraphEstimator::resume(EstimatorMemory memory) {
  graph_ = std::move(memory.graph);
  published_poses_ = graph_.poses;
  next_edge_ = memory.next_edge;
  robot_ = memory.robot;
  T_step_base_ = memory.T_step_base;
  waiting_ = std::move(memory.waiting);
  while (waiting_.size() > kMaxWaiting) waiting_.pop_front();
  postponed_ = memory.postponed;
  epoch_ = memory.epoch;
  accepted_ = memory.accepted;
  retracted_ = memory.retracted;
  changes_ = GraphChanges();
}

LoopFate GraphEstimator::add_loop(const LoopProposal& loop) {
  const auto count = static_cast<NodeId>(graph_.poses.size());
  if (!is_usable(loop.verdict) || loop.from < 0 || loop.to < 0 || loop.from >= count || loop.to >= count || loop.from == loop.to)
    return LoopFate::kRefused;
  bool trusted = false;
  if (agrees_with_graph(loop, trusted) && trusted) {
    accept(to_edge(loop));
    return LoopFate::kAccepted;
  }
  std::vector<std::size_t> friends;
  for (std::size_t k = 0; k < waiting_.size(); ++k)
    if (waiting_[k].to != loop.to && waiting_[k].verdict == loop.verdict &&  // one that is blind in a direction confirms nothing there
        consistent(waiting_[k], loop) &&
        std::all_of(friends.begin(), friends.end(), [&](std::size_t f) { return consistent(waiting_[f], waiting_[k]); }))
      friends.push_back(k);
  // Looks that are silent in a direction fit the equal room next door as well: they do not decide where a lost way ends.
  if (loop.verdict == Verdict::kOk && static_cast<std::int64_t>(friends.size()) >= config_.confirmations) {
    join_parts(loop);
    for (const std::size_t k : friends) accept(to_edge(waiting_[k]));
    for (auto k = friends.rbegin(); k != friends.rend(); ++k) waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(*k));
    accept(to_edge(loop));
    return LoopFate::kAccepted;
  }
  waiting_.push_back(loop);
  if (waiting_.size() > kMaxWaiting) waiting_.pop_front();
  return LoopFate::kWaiting;
}

/// Where a loop ties two parts together, brings the later one as a whole to where the loop says.
void GraphEstimator::join_parts(const LoopProposal& loop) {
  if (std::none_of(graph_.edges.begin(), graph_.edges.end(), is_break)) return;
  const std::vector<NodeId> parts = components(graph_.poses.size(), edges());
  const NodeId part_from = parts[static_cast<std::size_t>(loop.from)], part_to = parts[static_cast<std::size_t>(loop.to)];
  if (part_from == part_to) return;
  const Pose2 &T_map_from = graph_.poses[static_cast<std::size_t>(loop.from)], &T_map_to = graph_.poses[static_cast<std::size_t>(loop.to)];
  const bool moves_to = part_to > part_from;
  const Pose2 T = moves_to ? T_map_from * loop.T_from_to * T_map_to.inverse() : T_map_to * loop.T_from_to.inverse() * T_map_from.inverse();
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (parts[k] == (moves_to ? part_to : part_from)) graph_.poses[k] = T * graph_.poses[k];
  postponed_ = config_.postpone;  // to be optimised with the next loop
}

bool GraphEstimator::agrees_with_graph(const LoopProposal& loop, bool& trusted) const {
  const auto is_known = [&](const Eigen::Matrix3d& cov) { return std::sqrt(std::max(cov(0, 0), cov(1, 1))) < config_.trusted_sigma_m; };
  Eigen::Matrix3d cov_graph = RelativeCovariance(graph_.poses, edges(), loop.from, {loop.to})[loop.to];
  if (!is_known(cov_graph)) cov_graph = marginal_covariances(graph_.poses, edges(), loop.from)[static_cast<std::size_t>(loop.to)];
  trusted = is_known(cov_graph);
  const Pose2 T_graph = between(graph_.poses[static_cast<std::size_t>(loop.from)], graph_.poses[static_cast<std::size_t>(loop.to)]);
  Eigen::Vector3d d = loop.T_from_to.vector() - T_graph.vector();
  d[2] = wrap_angle(d[2]);
  const Eigen::Matrix3d slack = Eigen::Vector3d(9e-4, 9e-4, 1e-4).asDiagonal();
  return d.dot((cov_graph + loop_covariance(loop) + slack).ldlt().solve(d)) < kChi2_3dof_999;
}

/// Both loops tell the same story: old node of a -> new of a -> new of b -> old of b -> old of a closes.
bool GraphEstimator::consistent(const LoopProposal& a, const LoopProposal& b) const {
  const auto& poses = graph_.poses;
  const auto at = [&](NodeId id) { return poses[static_cast<std::size_t>(id)]; };
  const std::vector<const GraphEdge*> all = edges();
  const Pose2 T_new = between(at(a.to), at(b.to)), T_old = between(at(a.from), at(b.from));
  const Pose2 left = a.T_from_to * T_new, right = T_old * b.T_from_to;  // both: old node of a -> new node of b
  const Eigen::Matrix3d cov_left =
      compose_covariance(a.T_from_to, loop_covariance(a), T_new, RelativeCovariance(poses, all, a.to, {b.to})[b.to]);
  const Eigen::Matrix3d cov_right =
      compose_covariance(T_old, RelativeCovariance(poses, all, a.from, {b.from})[b.from], b.T_from_to, loop_covariance(b));
  Eigen::Vector3d d = left.vector() - right.vector();
  d[2] = wrap_angle(d[2]);
  const Eigen::Matrix3d slack = Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal();
  return d.dot((cov_left + cov_right + slack).ldlt().solve(d)) < kChi2_3dof_99;
}

/// Gives the edge its number.
void GraphEstimator::accept(GraphEdge edge) {
  edge.id = next_edge_++;
  graph_.edges.push_back(edge);
  changes_.added.push_back(edge);
  ++accepted_;
  ++postponed_;
  if (postponed_ >= config_.postpone || edge_chi2(edge, graph_.poses) > kUrgentChi2) optimize(false);
}

void GraphEstimator::settle(bool thoroughly) {
  if (postponed_ > 0 || thoroughly) optimize(thoroughly);
}

void GraphEstimator::optimize(bool thoroughly) {
  postponed_ = 0;
  OptimizeOptions options;
  options.dcs_phi = thoroughly ? config_.dcs_phi : 0.0;  // a kernel would spare the graph the large loops that it needs most
  options.max_iterations = thoroughly ? 50 : 6;
  options.stop_relative = thoroughly ? 1e-9 : 1e-3;
  do {
    if (config_.method == "toro")
      thoroughly ? toro_.optimize(graph_, options) : toro_.update(graph_, options);
    else
      optimize_gauss_newton(graph_, options);
  } while (retract_worst(graph_.edges.size()));
  note_moves();
}

void GraphEstimator::polish(const std::vector<GraphEdge>& overlaps) {
  std::size_t count = graph_.edges.size();  // the measurements stand behind the edges
  const std::vector<NodeId> parts = components(graph_.poses.size(), edges());
  std::copy_if(overlaps.begin(), overlaps.end(), std::back_inserter(graph_.edges), [&](const GraphEdge& edge) {
    return parts[static_cast<std::size_t>(edge.from)] == parts[static_cast<std::size_t>(edge.to)];
  });
  OptimizeOptions options;
  options.dcs_phi = config_.dcs_phi;
  options.max_iterations = 10;
  for (bool again = true; again; count -= again) {
    optimize_gauss_newton(graph_, options);
    again = retract_worst(count);
  }
  graph_.edges.resize(count);
  note_moves();
}

void GraphEstimator::note_moves() {
  bool any = false;
  for (std::size_t k = 0; k < graph_.poses.size(); ++k) {
    const Pose2 &now = graph_.poses[k], &then = published_poses_[k];
    if (distance(now, then) <= config_.moved_m && std::abs(wrap_angle(now.heading - then.heading)) <= config_.moved_rad) continue;
    published_poses_[k] = now;
    changes_.moved.push_back(static_cast<NodeId>(k));
    any = true;
  }
  if (any) ++epoch_;
}

/// Takes back the loop that contradicts the optimised graph most. @return whether there was one.
bool GraphEstimator::retract_worst(std::size_t among_first) {
  const auto end = graph_.edges.begin() + static_cast<std::ptrdiff_t>(among_first);
  auto worst = end;
  double worst_chi2 = config_.retract_chi2;
  for (auto edge = graph_.edges.begin(); edge != end; ++edge) {
    if (edge->kind != EdgeKind::kLoop) continue;
    const double chi2 = edge_chi2(*edge, graph_.poses);
    if (chi2 > worst_chi2) {
      worst_chi2 = chi2;
      worst = edge;
    }
  }
  if (worst == end) return false;
  changes_.retracted.push_back(worst->id);
  graph_.edges.erase(worst);
  ++retracted_;
  return true;
}

GraphChanges GraphEstimator::take_changes() {
  GraphChanges out = std::move(changes_);
  changes_ = GraphChanges();
  std::sort(out.moved.begin(), out.moved.end());
  out.moved.erase(std::unique(out.moved.begin(), out.moved.end()), out.moved.end());
  return out;
}

}  // namespace modslam
