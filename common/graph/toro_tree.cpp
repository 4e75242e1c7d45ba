// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/toro_tree.hpp"

#include <algorithm>

namespace modslam {

ToroTree::ToroTree(const PoseGraph& graph) : parent(graph.poses.size(), -1), level(graph.poses.size(), 0) {
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

ToroPath::ToroPath(const ToroTree& tree, const GraphEdge& edge) {
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

}  // namespace modslam
