// SPDX-License-Identifier: BSD-3-Clause
/// @file The spanning tree that TORO writes a pose graph's poses in.
#pragma once
#include <vector>

#include "common/graph/pose_graph.hpp"

namespace modslam {

/// Spanning tree in which a node hangs below the neighbour with the smallest id; node 0 is the root.
struct ToroTree {
  std::vector<NodeId> parent;
  std::vector<int> level;

  explicit ToroTree(const PoseGraph& graph);
};

/// The nodes whose parameters lie between the two ends of an edge: up from each end to their common ancestor, without it.
struct ToroPath {
  std::vector<std::size_t> from_side, to_side;
  int top_level = 0;

  ToroPath(const ToroTree& tree, const GraphEdge& edge);
  std::size_t length() const { return from_side.size() + to_side.size(); }

  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const auto* side : {&from_side, &to_side})
      for (const std::size_t v : *side) visit(v);
  }
};

}  // namespace modslam
