// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/relative_covariance.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <queue>

#include "common/graph/sparse_optimizer.hpp"

namespace modslam {
namespace {

/// The edges that touch each node, in one array ordered by node.
class EdgesByNode {
 public:
  EdgesByNode(std::size_t nodes, const std::vector<const GraphEdge*>& edges) : start_(nodes + 1, 0), edges_(2 * edges.size()) {
    for (const GraphEdge* edge : edges)
      for (const NodeId id : {edge->from, edge->to}) ++start_[static_cast<std::size_t>(id) + 1];
    for (std::size_t k = 0; k < nodes; ++k) start_[k + 1] += start_[k];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (const GraphEdge* edge : edges)
      for (const NodeId id : {edge->from, edge->to}) edges_[next[static_cast<std::size_t>(id)]++] = edge;
  }
  const GraphEdge* const* begin(std::size_t node) const { return edges_.data() + start_[node]; }
  const GraphEdge* const* end(std::size_t node) const { return edges_.data() + start_[node + 1]; }

 private:
  std::vector<std::size_t> start_;
  std::vector<const GraphEdge*> edges_;
};

}  // namespace

Eigen::Matrix3d edge_covariance_from(const GraphEdge& edge) {
  const Eigen::Matrix3d floor = Eigen::Vector3d(1e-2, 1e-2, 1e-1).asDiagonal();  // 10 m, 3 rad
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(edge.T_from_to.heading);
  return R * (edge.information + floor).inverse() * R.transpose();
}

RelativeCovariance::RelativeCovariance(const std::vector<Pose2>& poses, const std::vector<const GraphEdge*>& edges,
                                       NodeId source, const std::vector<NodeId>& targets) {
  constexpr double kUnreached = 1e6;
  covariance_.assign(poses.size(), kUnreached * Eigen::Matrix3d::Identity());
  const EdgesByNode edges_at(poses.size(), edges);
  std::vector<bool> wanted(poses.size(), targets.empty());
  for (const NodeId id : targets) wanted[static_cast<std::size_t>(id)] = true;
  auto missing = std::count(wanted.begin(), wanted.end(), true);
  using Item = std::pair<double, NodeId>;
  std::priority_queue<Item, std::vector<Item>, std::greater<Item>> open;
  std::vector<bool> done(poses.size(), false);
  std::vector<double> best(poses.size(), kUnreached);
  covariance_[static_cast<std::size_t>(source)].setZero();
  open.push({0.0, source});
  while (!open.empty()) {
    const auto at = static_cast<std::size_t>(open.top().second);
    open.pop();
    if (done[at]) continue;
    done[at] = true;
    if (wanted[at] && --missing == 0) break;
    const Pose2 T_source_at = between(poses[static_cast<std::size_t>(source)], poses[at]);
    for (const GraphEdge* const* k = edges_at.begin(at); k != edges_at.end(at); ++k) {
      const GraphEdge* edge = *k;
      const bool forward = static_cast<std::size_t>(edge->from) == at;
      const auto other = static_cast<std::size_t>(forward ? edge->to : edge->from);
      if (done[other]) continue;
      Eigen::Matrix3d cov_step = edge_covariance_from(*edge);
      const Pose2 T_at_other = between(poses[at], poses[other]);
      if (!forward) {
        // The edge errs in the frame of `other`. d inverse(T) = -[R' (dt - J t dheading), dheading], and for t = R' t of the
        // inverse that is, up to the common sign, [R_at_other dt + (y, -x) of T_at_other dheading, dheading].
        Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
        J.topLeftCorner<2, 2>() = rotation(T_at_other.heading);
        J(0, 2) = -T_at_other.y;
        J(1, 2) = T_at_other.x;
        cov_step = J * cov_step * J.transpose();
      }
      const Eigen::Matrix3d cov = compose_covariance(T_source_at, covariance_[at], T_at_other, cov_step);
      const double size = cov(0, 0) + cov(1, 1);
      if (size >= best[other]) continue;
      best[other] = size;
      covariance_[other] = cov;
      open.push({size, static_cast<NodeId>(other)});
    }
  }
}

std::vector<Eigen::Matrix3d> marginal_covariances(const std::vector<Pose2>& poses, const std::vector<const GraphEdge*>& edges, NodeId source) {
  // The optimiser holds node 0, so `source` and node 0 change names.
  const auto renamed = [&](NodeId id) { return id == source ? 0 : id == 0 ? source : id; };
  PoseGraph graph;
  graph.poses = poses;
  std::swap(graph.poses[0], graph.poses[static_cast<std::size_t>(source)]);
  for (const GraphEdge* edge : edges) {
    graph.edges.push_back(*edge);
    graph.edges.back().from = renamed(edge->from);
    graph.edges.back().to = renamed(edge->to);
  }
  SparseOptimizer optimizer(graph);
  optimizer.prepare_marginals(graph);
  std::vector<Eigen::Matrix3d> covariances = optimizer.marginals();
  std::swap(covariances[0], covariances[static_cast<std::size_t>(source)]);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(-graph.poses[0].heading);
  for (Eigen::Matrix3d& cov : covariances) cov = R * cov * R.transpose();
  return covariances;
}

}  // namespace modslam
