// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "common/graph/sparse_optimizer.hpp"

namespace modslam {

double graph_chi2(const PoseGraph& graph) {
  double sum = 0;
  for (const GraphEdge& edge : graph.edges) sum += edge_chi2(edge, graph.poses);
  return sum;
}

OptimizeResult optimize_gauss_newton(PoseGraph& graph, const OptimizeOptions& options) {
  return SparseOptimizer(graph).optimize(graph, options);
}

void initialize_from_tree(PoseGraph& graph) {
  std::vector<std::vector<std::size_t>> edges_at(graph.poses.size());
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    edges_at[static_cast<std::size_t>(graph.edges[k].from)].push_back(k);
    edges_at[static_cast<std::size_t>(graph.edges[k].to)].push_back(k);
  }
  std::vector<bool> placed(graph.poses.size(), false);
  std::vector<std::size_t> queue{0};
  placed[0] = true;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const std::size_t at = queue[head];
    for (const std::size_t k : edges_at[at]) {
      const GraphEdge& edge = graph.edges[k];
      const bool forward = static_cast<std::size_t>(edge.from) == at;
      const auto other = static_cast<std::size_t>(forward ? edge.to : edge.from);
      if (placed[other]) continue;
      graph.poses[other] = graph.poses[at] * (forward ? edge.T_from_to : edge.T_from_to.inverse());
      placed[other] = true;
      queue.push_back(other);
    }
  }
}

void initialize_from_odometry(PoseGraph& graph) {
  initialize_from_tree(graph);
  std::vector<const GraphEdge*> step_to(graph.poses.size(), nullptr);
  for (const GraphEdge& edge : graph.edges)
    if (edge.kind == EdgeKind::kSequence) step_to[static_cast<std::size_t>(std::max(edge.from, edge.to))] = &edge;
  for (std::size_t k = 1; k < graph.poses.size(); ++k) {
    if (!step_to[k]) continue;
    const Pose2& T = step_to[k]->T_from_to;
    graph.poses[k] = graph.poses[k - 1] * (step_to[k]->from < step_to[k]->to ? T : T.inverse());
  }
}

}  // namespace modslam
