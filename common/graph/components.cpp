// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/components.hpp"

#include "common/graph/disjoint_sets.hpp"

namespace modslam {

std::vector<NodeId> components(std::size_t nodes, const std::vector<const GraphEdge*>& edges) {
  DisjointSets sets(nodes);
  for (const GraphEdge* edge : edges)
    if (!is_break(*edge)) sets.join_lowest(static_cast<std::size_t>(edge->from), static_cast<std::size_t>(edge->to));
  std::vector<NodeId> lowest;
  for (std::size_t k = 0; k < nodes; ++k) lowest.push_back(static_cast<NodeId>(sets.root(k)));
  return lowest;
}

}  // namespace modslam
