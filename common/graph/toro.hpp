// SPDX-License-Identifier: BSD-3-Clause
/// @file Tree-based network optimisation, of a whole graph or of what is new in it, from the formulas of the papers.
///
/// Node v's parameter z_v = p_v - p_parent(v), component by component in the map frame, so a pose is the sum of the parameters from
/// the root. Each edge in turn pulls its own error out of the parameters on the path between its two nodes, shared by how firmly other
/// edges hold each of them (M, diagonal), with a learning rate that falls as 1 / n (Grisetti, Stachniss, Grzonka, Burgard, RSS 2007).
#pragma once
#include <vector>

#include "common/graph/pose_graph.hpp"

namespace modslam {

class Toro {
 public:
  /// The whole graph, every node at the full rate.
  OptimizeResult optimize(PoseGraph& graph, const OptimizeOptions& options);

  /// Spreads the errors of the edges that came since the last call, known by their ids, over the part of the graph that they move. Every
  /// node has a rate of its own, which falls as the graph settles there and rises with how much a new edge says about it (Grisetti, Lodi
  /// Rizzini, Stachniss, Olson, Burgard, ICRA 2008). Edges may be gone since the last call; poses may have been moved by others.
  OptimizeResult update(PoseGraph& graph, const OptimizeOptions& options);

  /// How often an edge has pulled, over all calls: what the work is measured in.
  std::int64_t pulls() const { return pulls_; }

 private:
  std::vector<double> rate_;   ///< of each node
  std::vector<EdgeId> known_;  ///< edges that have had their turn, in the order of the graph
  std::int64_t pulls_ = 0;
};

}  // namespace modslam
