// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/toro.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/graph/toro_tree.hpp"

namespace modslam {
namespace {

constexpr double kLeastInformation = 1e-6;
constexpr double kStill = 0.02;        // of a parameter's standard deviation; one that moves less wakes no other edge
constexpr double kSpread = 0.5;        // of its rate an edge leaves with the nodes that it moves
constexpr int kLeastSweeps = 30, kStillSweeps = 3;

Eigen::Matrix3d information_in_map(const GraphEdge& edge, double heading_from) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(heading_from + edge.T_from_to.heading);
  return R * edge.information * R.transpose();
}

/// One optimisation: the graph's poses as parameters of a tree, and the edges that pull at them.
class Descent {
 public:
  Descent(PoseGraph& graph, std::vector<double>& rate);
  /// How firmly the edges hold each parameter, at the present headings.
  void weigh();
  /// Share of what is now known between an edge's ends that the edge itself says, 0 to 1, mean of the three axes.
  double say(std::size_t k) const;
  void raise(std::size_t k, double rate);
  /// Lets every edge pull in every sweep until chi2 settles, with new weights for each.
  OptimizeResult run(const OptimizeOptions& options);
  /// Lets some edges begin; another one joins when its path was moved.
  OptimizeResult run(const OptimizeOptions& options, const std::vector<bool>& first);
  std::int64_t pulls() const { return pulls_; }

 private:
  Eigen::Vector3d pose_of(NodeId id) const;
  OptimizeResult run(const OptimizeOptions& options, bool whole);
  bool was_moved(std::size_t k) const;
  void pull(std::size_t k);
  void sweep(bool whole);
  void write_poses();

  PoseGraph& graph_;
  std::vector<double>& rate_;
  ToroTree tree_;
  std::vector<ToroPath> paths_;
  std::vector<std::size_t> order_;        // edges, those with the highest top first
  std::vector<Eigen::Vector3d> z_;        // headings stay unwrapped so that sums of them are continuous
  std::vector<Eigen::Vector3d> weight_;   // of each edge, diagonal of its information in the map frame
  std::vector<Eigen::Vector3d> M_;
  Eigen::Vector3d gamma_;
  std::vector<std::int64_t> moved_at_, pulled_at_;  // count of pulls when a node's parameter moved, when an edge pulled
  std::int64_t pulls_ = 0;
};

Descent::Descent(PoseGraph& graph, std::vector<double>& rate)
    : graph_(graph), rate_(rate), tree_(graph), order_(graph.edges.size()), z_(graph.poses.size(), Eigen::Vector3d::Zero()),
      weight_(graph.edges.size()), M_(graph.poses.size()), moved_at_(graph.poses.size(), 0), pulled_at_(graph.edges.size(), 0) {
  for (const GraphEdge& edge : graph.edges) paths_.emplace_back(tree_, edge);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return paths_[a].top_level < paths_[b].top_level; });
  for (std::size_t v = 1; v < z_.size(); ++v) {
    z_[v] = graph.poses[v].vector() - graph.poses[static_cast<std::size_t>(tree_.parent[v])].vector();
    z_[v][2] = wrap_angle(z_[v][2]);
  }
  weigh();
}

Eigen::Vector3d Descent::pose_of(NodeId id) const {
  Eigen::Vector3d p = graph_.poses[0].vector();
  for (auto v = static_cast<std::size_t>(id); v != 0; v = static_cast<std::size_t>(tree_.parent[v])) p += z_[v];
  return p;
}

void Descent::weigh() {
  std::fill(M_.begin(), M_.end(), Eigen::Vector3d::Zero());
  gamma_.setConstant(std::numeric_limits<double>::max());
  for (std::size_t k = 0; k < weight_.size(); ++k) {
    const GraphEdge& edge = graph_.edges[k];
    const double heading_from = graph_.poses[static_cast<std::size_t>(edge.from)].heading;
    weight_[k] = information_in_map(edge, heading_from).diagonal().cwiseMax(kLeastInformation);
    paths_[k].for_each([&](std::size_t v) { M_[v] += weight_[k]; });
    if (paths_[k].length()) gamma_ = gamma_.cwiseMin(weight_[k]);
  }
}

double Descent::say(std::size_t k) const {
  Eigen::Vector3d unsure = Eigen::Vector3d::Zero();  // of the path without this edge
  paths_[k].for_each([&](std::size_t v) { unsure += (M_[v] - weight_[k]).cwiseMax(kLeastInformation).cwiseInverse(); });
  return (weight_[k].array() / (weight_[k] + unsure.cwiseInverse()).array()).mean();
}

void Descent::raise(std::size_t k, double rate) {
  paths_[k].for_each([&](std::size_t v) { rate_[v] = std::max(rate_[v], rate); });
}

bool Descent::was_moved(std::size_t k) const {
  bool moved = false;
  paths_[k].for_each([&](std::size_t v) { moved = moved || moved_at_[v] > pulled_at_[k]; });
  return moved;
}

void Descent::pull(std::size_t k) {
  const ToroPath& path = paths_[k];
  const GraphEdge& edge = graph_.edges[k];
  pulled_at_[k] = ++pulls_;
  const Eigen::Vector3d p_from = pose_of(edge.from), p_to = pose_of(edge.to);
  Eigen::Vector3d r = (Pose2(p_from) * edge.T_from_to).vector() - p_to;
  r[2] = wrap_angle(r[2]);
  const Eigen::Vector3d d = 2 * information_in_map(edge, p_from[2]) * r;
  double rate = 0;
  Eigen::Vector3d held = Eigen::Vector3d::Zero();
  path.for_each([&](std::size_t v) {
    rate = std::max(rate, rate_[v]);
    held += M_[v].cwiseInverse();
  });
  Eigen::Vector3d step = static_cast<double>(path.length()) * rate * d.cwiseQuotient(gamma_);
  step = step.cwiseMax(-r.cwiseAbs()).cwiseMin(r.cwiseAbs());  // never past this edge's own error
  const auto move = [&](const std::vector<std::size_t>& side, double sign) {
    for (const std::size_t v : side) {
      const Eigen::Vector3d dz = sign * step.cwiseQuotient(M_[v].cwiseProduct(held));
      z_[v] += dz;
      if (dz.cwiseProduct(M_[v].cwiseSqrt()).cwiseAbs().maxCoeff() < kStill) continue;
      moved_at_[v] = pulls_;
      rate_[v] = std::max(rate_[v], kSpread * rate);
    }
  };
  move(path.to_side, 1);
  move(path.from_side, -1);
}

void Descent::sweep(bool whole) {
  for (const std::size_t k : order_)
    if (paths_[k].length() > 0 && (whole || was_moved(k))) pull(k);
  for (double& rate : rate_) rate /= 1 + rate;  // 1, 1/2, 1/3 ...
}

/// A parent's id is smaller than its children's.
void Descent::write_poses() {
  std::vector<Eigen::Vector3d> p(z_.size(), graph_.poses[0].vector());
  for (std::size_t v = 1; v < p.size(); ++v) {
    p[v] = p[static_cast<std::size_t>(tree_.parent[v])] + z_[v];
    graph_.poses[v] = Pose2(p[v].x(), p[v].y(), wrap_angle(p[v].z()));
  }
}

OptimizeResult Descent::run(const OptimizeOptions& options) { return run(options, true); }

OptimizeResult Descent::run(const OptimizeOptions& options, const std::vector<bool>& first) {
  for (std::size_t k = 0; k < first.size(); ++k)
    if (first[k]) pulled_at_[k] = -1;
  return run(options, false);
}

OptimizeResult Descent::run(const OptimizeOptions& options, bool whole) {
  OptimizeResult result;
  result.chi2_before = result.chi2_after = graph_chi2(graph_);
  std::vector<Pose2> best = graph_.poses;
  double last_chi2 = result.chi2_before;
  int still = 0;
  for (int n = 1; n <= std::max(options.max_iterations, kLeastSweeps) && still < kStillSweeps; ++n) {
    if (whole && n > 1) weigh();
    const std::int64_t pulls_before = pulls_;
    sweep(whole);
    if (pulls_ == pulls_before) break;  // nothing moves any more
    write_poses();
    result.iterations = n;
    const double chi2 = graph_chi2(graph_);
    // A sweep may only hand an error from one edge to the next: chi2 has settled when it stands still several times.
    still = std::abs(last_chi2 - chi2) <= options.stop_relative * chi2 ? still + 1 : 0;
    last_chi2 = chi2;
    if (chi2 < result.chi2_after) {
      result.chi2_after = chi2;
      best = graph_.poses;
    }
  }
  graph_.poses = std::move(best);
  return result;
}

std::vector<EdgeId> ids_of(const PoseGraph& graph) {
  std::vector<EdgeId> ids;
  for (const GraphEdge& edge : graph.edges) ids.push_back(edge.id);
  return ids;
}

}  // namespace

OptimizeResult Toro::optimize(PoseGraph& graph, const OptimizeOptions& options) {
  rate_.assign(graph.poses.size(), 1.0);
  known_ = ids_of(graph);
  if (graph.poses.size() < 2 || graph.edges.empty()) return {graph_chi2(graph), graph_chi2(graph), 0};
  Descent descent(graph, rate_);
  const OptimizeResult result = descent.run(options);
  pulls_ += descent.pulls();
  return result;
}

OptimizeResult Toro::update(PoseGraph& graph, const OptimizeOptions& options) {
  if (graph.poses.size() < 2 || graph.edges.empty()) return {graph_chi2(graph), graph_chi2(graph), 0};
  rate_.resize(graph.poses.size(), 0.0);
  Descent descent(graph, rate_);
  std::vector<bool> is_new(graph.edges.size(), true);
  // Both lists are in the order in which the edges came.
  for (std::size_t k = 0, at = 0; k < is_new.size(); ++k) {
    const auto found = std::find(known_.begin() + static_cast<std::ptrdiff_t>(at), known_.end(), graph.edges[k].id);
    if (found == known_.end()) {
      descent.raise(k, descent.say(k));
      continue;
    }
    is_new[k] = false;
    at = static_cast<std::size_t>(found - known_.begin()) + 1;
  }
  known_ = ids_of(graph);
  const OptimizeResult result = descent.run(options, is_new);
  pulls_ += descent.pulls();
  return result;
}

}  // namespace modslam
