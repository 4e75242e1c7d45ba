// SPDX-License-Identifier: BSD-3-Clause
/// Tree-based network optimisation from the formulas of Grisetti, Stachniss, Grzonka, Burgard, RSS 2007.
///
/// Node v's parameter z_v = p_v - p_parent(v), component by component in the map frame, so a pose is the sum of the parameters from
/// the root. Each edge in turn pulls its own error out of the parameters on the path between its two nodes, shared by
/// how firmly other edges hold each of them (M, diagonal), with a learning rate that falls as 1 / n.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/graph/pose_graph.hpp"

namespace modslam {
namespace {

/// Spanning tree in which a node hangs below the neighbour with the smallest id.
struct Tree {
  std::vector<NodeId> parent;
  std::vector<int> level;

  explicit Tree(const PoseGraph& graph) : parent(graph.poses.size(), -1), level(graph.poses.size(), 0) {
    for (const GraphEdge& edge : graph.edges) {
      const NodeId low = std::min(edge.from, edge.to), high = std::max(edge.from, edge.to);
      NodeId& p = parent[static_cast<std::size_t>(high)];
      if (p < 0 || low < p) p = low;
    }
    for (std::size_t v = 1; v < parent.size(); ++v) {
      if (parent[v] < 0) parent[v] = 0;
      level[v] = level[static_cast<std::size_t>(parent[v])] + 1;
    }
  }
};

/// The nodes whose parameters lie between the two ends of an edge: up from each end to their common ancestor, without it.
struct Path {
  std::vector<std::size_t> from_side, to_side;
  int top_level = 0;

  Path(const Tree& tree, const GraphEdge& edge) {
    auto a = static_cast<std::size_t>(edge.from), b = static_cast<std::size_t>(edge.to);
    while (a != b) {
      if (tree.level[a] >= tree.level[b]) {
        from_side.push_back(a);
        a = static_cast<std::size_t>(tree.parent[a]);
      } else {
        to_side.push_back(b);
        b = static_cast<std::size_t>(tree.parent[b]);
      }
    }
    top_level = tree.level[a];
  }
  std::size_t length() const { return from_side.size() + to_side.size(); }
};

Eigen::Matrix3d information_in_map(const GraphEdge& edge, double heading_from) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(heading_from + edge.T_from_to.heading);
  return R * edge.information * R.transpose();
}

}  // namespace

OptimizeResult optimize_toro(PoseGraph& graph, const OptimizeOptions& options) {
  OptimizeResult result;
  result.chi2_before = result.chi2_after = graph_chi2(graph);
  const std::size_t n = graph.poses.size();
  if (n < 2 || graph.edges.empty()) return result;

  const Tree tree(graph);
  std::vector<Path> paths;
  for (const GraphEdge& edge : graph.edges) paths.emplace_back(tree, edge);
  std::vector<std::size_t> order(graph.edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return paths[a].top_level < paths[b].top_level; });

  // Parameters; headings stay unwrapped so that sums of them are continuous.
  std::vector<Eigen::Vector3d> z(n, Eigen::Vector3d::Zero());
  for (std::size_t v = 1; v < n; ++v) {
    z[v] = graph.poses[v].vector() - graph.poses[static_cast<std::size_t>(tree.parent[v])].vector();
    z[v][2] = wrap_angle(z[v][2]);
  }
  const Eigen::Vector3d root = graph.poses[0].vector();
  const auto pose_of = [&](NodeId id) {
    Eigen::Vector3d p = root;
    for (auto v = static_cast<std::size_t>(id); v != 0; v = static_cast<std::size_t>(tree.parent[v])) p += z[v];
    return p;
  };

  std::vector<Pose2> best = graph.poses;
  double last_chi2 = result.chi2_before;
  int still = 0;
  const int sweeps = std::max(options.max_iterations, 30);
  for (int sweep = 1; sweep <= sweeps; ++sweep) {
    // Preconditioner: how firmly the edges hold each parameter.
    std::vector<Eigen::Vector3d> M(n, Eigen::Vector3d::Zero());
    Eigen::Vector3d gamma = Eigen::Vector3d::Constant(1e300);
    for (std::size_t k = 0; k < graph.edges.size(); ++k) {
      const Eigen::Vector3d w =
          information_in_map(graph.edges[k], pose_of(graph.edges[k].from)[2]).diagonal().cwiseMax(1e-6);
      for (const auto* side : {&paths[k].from_side, &paths[k].to_side})
        for (const std::size_t v : *side) M[v] += w;
      if (paths[k].length()) gamma = gamma.cwiseMin(w);
    }
    for (const std::size_t k : order) {
      const Path& path = paths[k];
      if (path.length() == 0) continue;
      const GraphEdge& edge = graph.edges[k];
      const Eigen::Vector3d p_from = pose_of(edge.from), p_to = pose_of(edge.to);
      Eigen::Vector3d r = (Pose2(p_from) * edge.T_from_to).vector() - p_to;
      r[2] = wrap_angle(r[2]);
      const Eigen::Vector3d d = 2 * information_in_map(edge, p_from[2]) * r;
      for (int axis = 0; axis < 3; ++axis) {
        double held = 0;
        for (const auto* side : {&path.from_side, &path.to_side})
          for (const std::size_t v : *side) held += 1 / M[v][axis];
        const double rate = 1.0 / (gamma[axis] * sweep);
        double step = static_cast<double>(path.length()) * rate * d[axis];
        step = std::clamp(step, -std::abs(r[axis]), std::abs(r[axis]));  // never past this edge's own error
        for (const std::size_t v : path.to_side) z[v][axis] += step / (M[v][axis] * held);
        for (const std::size_t v : path.from_side) z[v][axis] -= step / (M[v][axis] * held);
      }
    }
    for (std::size_t v = 1; v < n; ++v) graph.poses[v] = Pose2(pose_of(static_cast<NodeId>(v)));
    for (Pose2& pose : graph.poses) pose.heading = wrap_angle(pose.heading);
    result.iterations = sweep;
    const double chi2 = graph_chi2(graph);
    // A sweep may only hand an error from one edge to the next: chi2 has settled when it stands still three times.
    still = std::abs(last_chi2 - chi2) <= options.stop_relative * chi2 ? still + 1 : 0;
    last_chi2 = chi2;
    if (chi2 < result.chi2_after) {
      result.chi2_after = chi2;
      best = graph.poses;
    }
    if (still == 3) break;
  }
  graph.poses = std::move(best);
  return result;
}

}  // namespace modslam
