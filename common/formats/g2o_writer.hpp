// SPDX-License-Identifier: BSD-3-Clause
/// @file Pose graphs as g2o reads them: VERTEX_SE2, EDGE_SE2 (information xx xy xt yy yt tt), FIX.
#pragma once
#include <map>
#include <string>

#include "common/graph/types.hpp"

namespace modslam {

/// The lowest vertex is fixed. Edges to vertices that are not there would end every reader: they
/// are left out.
/// @param edges_left_out  when given, counts those.
std::string g2o_text(const std::map<NodeId, Pose2>& T_map_node,
                     const std::map<EdgeId, GraphEdge>& edges, int* edges_left_out = nullptr);

}  // namespace modslam
