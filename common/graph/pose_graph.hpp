// SPDX-License-Identifier: BSD-3-Clause
/// @file A pose graph and its error.
#pragma once
#include <vector>

#include "common/graph/types.hpp"

namespace modslam {

/// poses[id] is T_map_node; node 0 stands still.
struct PoseGraph {
  std::vector<Pose2> poses;
  std::vector<GraphEdge> edges;
};

/// Error of one edge: (x, y, heading) of inverse(z) * inverse(T_from) * T_to, in the frame of the measured node.
inline Eigen::Vector3d edge_error(const GraphEdge& edge, const Pose2& T_map_from, const Pose2& T_map_to) {
  return between(edge.T_from_to, between(T_map_from, T_map_to)).vector();
}

inline double edge_chi2(const GraphEdge& edge, const Pose2& T_map_from, const Pose2& T_map_to) {
  const Eigen::Vector3d e = edge_error(edge, T_map_from, T_map_to);
  return e.dot(edge.information * e);
}

inline double edge_chi2(const GraphEdge& edge, const std::vector<Pose2>& poses) {
  return edge_chi2(edge, poses[static_cast<std::size_t>(edge.from)], poses[static_cast<std::size_t>(edge.to)]);
}

/// Sum over all edges (g2o's definition).
double graph_chi2(const PoseGraph& graph);

struct OptimizeOptions {
  int max_iterations = 20;
  double stop_relative = 1e-6;  ///< relative change of chi2
  /// Dynamic covariance scaling of loop edges (Agarwal et al., ICRA 2013): weight min(1, 2 phi / (phi + chi2))^2; 0 = off.
  double dcs_phi = 0.0;
};

struct OptimizeResult {
  double chi2_before = 0, chi2_after = 0;
  int iterations = 0;
};

/// Sparse Gauss-Newton from the present poses, see SparseOptimizer.
OptimizeResult optimize_gauss_newton(PoseGraph& graph, const OptimizeOptions& options);

/// Poses from node 0 along a breadth-first spanning tree of the edges.
void initialize_from_tree(PoseGraph& graph);

/// Poses along the sequence edges, which lead from each node to the next; a node without one stands where the tree has it.
void initialize_from_odometry(PoseGraph& graph);

}  // namespace modslam
