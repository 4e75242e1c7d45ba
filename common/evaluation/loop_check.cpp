// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/loop_check.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "common/graph/pose_graph.hpp"

namespace modslam {
namespace {

constexpr double kKnown = 1 / (0.2 * 0.2);  // information, 1/m2

/// Length of the part of an error that lies in directions the edge claims to know.
double error_where_known(const GraphEdge& edge, const Eigen::Vector3d& error) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(edge.information.topLeftCorner<2, 2>());
  Eigen::Vector2d along = axes.eigenvectors().transpose() * error.head<2>();
  for (int k = 0; k < 2; ++k)
    if (axes.eigenvalues()[k] < kKnown) along[k] = 0;
  return along.norm();
}

}  // namespace

LoopCheck check_loops(const std::vector<GraphEdge>& edges, const std::map<NodeId, Pose2>& T_map_node) {
  LoopCheck check;
  for (const GraphEdge& edge : edges) {
    if (edge.kind != EdgeKind::kLoop) continue;
    const auto from = T_map_node.find(edge.from), to = T_map_node.find(edge.to);
    if (from == T_map_node.end() || to == T_map_node.end()) continue;
    ++check.loops;
    const Eigen::Vector3d error = edge_error(edge, from->second, to->second);
    check.worst_chi2 = std::max(check.worst_chi2, error.dot(edge.information * error));
    const double error_m = error_where_known(edge, error);
    if (error_m < check.worst_m) continue;
    check.worst_m = error_m;
    check.from = edge.from;
    check.to = edge.to;
  }
  return check;
}

}  // namespace modslam
