// SPDX-License-Identifier: BSD-3-Clause
/// @file Every pair of nodes that see the same surfaces, measured once more: what the final polish adds to the graph.
///
/// While driving, a scan is matched to the local map of the moment and to one earlier pass. When the run is over all poses are nearly
/// right, so each scan can be compared with every scan taken near it: partners are found by projection into the other scan's beams, the
/// relative pose by point-to-line Gauss-Newton, and the graph is solved once more with all of it (after Lu and Milios, Autonomous
/// Robots 1997, with point-to-line information in place of their consistent pose estimation).
#pragma once
#include <vector>

#include "common/graph/types.hpp"
#include "common/matching/submap.hpp"

namespace modslam {

/// @param nodes poses that are nearly right, points in the robot frame in the order of the beams.
/// @return edges (kind kLoop, ids 0, 1, ...) from earlier to later nodes; information is 0 in directions nothing was seen of.
std::vector<GraphEdge> measure_overlaps(std::vector<Keyframe> nodes);

}  // namespace modslam
