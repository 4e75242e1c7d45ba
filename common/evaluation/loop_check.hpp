// SPDX-License-Identifier: BSD-3-Clause
/// @file Whether a graph's loops are right: how far what they say is from where their nodes are.
#pragma once
#include <map>
#include <vector>

#include "common/graph/types.hpp"

namespace modslam {

struct LoopCheck {
  std::int64_t loops = 0;   ///< loop edges whose two nodes have a pose
  double worst_chi2 = 0;    ///< largest squared error in units of an edge's covariance
  double worst_m = 0;       ///< largest error of a place, in the directions that the loop claims to know better than 0.2 m
  NodeId from = -1, to = -1;  ///< the edge that is worst in metres
};

/// @param T_map_node where the nodes are: as the graph left them, or as they truly were. Edges of other kinds are not looked at.
LoopCheck check_loops(const std::vector<GraphEdge>& edges, const std::map<NodeId, Pose2>& T_map_node);

}  // namespace modslam
