// SPDX-License-Identifier: BSD-3-Clause
/// @file Pose graphs as g2o and TORO write them.
///
///   g2o   VERTEX_SE2 id x y heading      EDGE_SE2 from to x y heading  xx xy xt yy yt tt      FIX id
///   TORO  VERTEX2 id x y heading         EDGE2 from to x y heading  xx xy yy tt xt yt
///
/// The last six numbers are the information (x y heading); the two differ in their order. '#' starts a comment.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "common/graph/pose_graph.hpp"

namespace modslam {

struct GraphFile {
  /// Ids of the vertices as the file has them, ascending; graph.poses and the ends of graph.edges are indices into it. Edges keep the
  /// file's order and number. The first edge from each vertex to the next one (or back) is a sequence edge, all others are loops.
  std::vector<std::int64_t> ids;
  PoseGraph graph;
  std::size_t fixed = 0;      ///< index of the vertex that FIX names; 0 without one
  bool has_vertices = false;  ///< false: the file holds edges alone; poses are from a spanning tree
};

/// Reads either format; which one shows in each line.
/// @throws std::runtime_error "line N: ..." where the text is no planar pose graph: fields missing or not finite, information with a
/// negative direction or none at all, vertices twice or unknown, edges from a vertex to itself, 3D files, landmarks, more than one FIX.
GraphFile parse_graph(std::string_view text);

enum class GraphFormat { kG2o, kToro };
/// Numbers are as short as they can be and still read back as the same double.
std::string graph_text(const GraphFile& file, GraphFormat format);

}  // namespace modslam
