// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/g2o_writer.hpp"

#include <cinttypes>
#include <cstdio>

namespace modslam {

std::string g2o_text(const std::map<NodeId, Pose2>& T_map_node,
                     const std::map<EdgeId, GraphEdge>& edges, int* edges_left_out) {
  std::string text;
  char line[512];
  for (const auto& [id, pose] : T_map_node) {
    std::snprintf(line, sizeof line, "VERTEX_SE2 %" PRId64 " %.9f %.9f %.9f\n", id, pose.x, pose.y,
                  pose.heading);
    text += line;
  }
  if (!T_map_node.empty()) text += "FIX " + std::to_string(T_map_node.begin()->first) + "\n";
  for (const auto& [id, edge] : edges) {
    if (!T_map_node.count(edge.from) || !T_map_node.count(edge.to)) {
      if (edges_left_out) ++*edges_left_out;
      continue;
    }
    const Pose2& T = edge.T_from_to;
    const Eigen::Matrix3d& I = edge.information;
    std::snprintf(line, sizeof line,
                  "EDGE_SE2 %" PRId64 " %" PRId64 " %.9f %.9f %.9f %.9g %.9g %.9g %.9g %.9g %.9g\n",
                  edge.from, edge.to, T.x, T.y, T.heading, I(0, 0), I(0, 1), I(0, 2), I(1, 1),
                  I(1, 2), I(2, 2));
    text += line;
  }
  return text;
}

}  // namespace modslam
