// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/components.hpp"

#include <algorithm>
#include <numeric>

namespace modslam {

std::vector<NodeId> components(std::size_t nodes, const std::vector<const GraphEdge*>& edges) {
  std::vector<NodeId> lowest(nodes);
  std::iota(lowest.begin(), lowest.end(), NodeId{0});
  const auto root = [&](NodeId id) {
    while (lowest[static_cast<std::size_t>(id)] != id) {
      NodeId& up = lowest[static_cast<std::size_t>(id)];
      up = lowest[static_cast<std::size_t>(up)];
      id = up;
    }
    return id;
  };
  for (const GraphEdge* edge : edges) {
    if (is_break(*edge)) continue;
    const NodeId a = root(edge->from), b = root(edge->to);
    lowest[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  for (std::size_t k = 0; k < nodes; ++k) lowest[k] = root(static_cast<NodeId>(k));
  return lowest;
}

}  // namespace modslam
