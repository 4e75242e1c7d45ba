// SPDX-License-Identifier: BSD-3-Clause
/// @file Wrong loops for graphs whose answer is known.
#pragma once
#include "common/graph/pose_graph.hpp"
#include "common/world/random.hpp"

namespace modslam::test {

enum class FalseLoops {
  kSamePlace,  ///< two random nodes are called the same place, within 0.3 m and 10 deg
  kAnywhere,   ///< two random nodes, any motion within `size_m`
};

/// Appends `count` loops that are wrong by 1 m or 0.5 rad at least, with the information of loops that the graph has.
/// @param truth  the poses that are right.
inline void add_false_loops(PoseGraph& graph, const std::vector<Pose2>& truth, int count, FalseLoops kind, double size_m,
                            std::uint64_t seed) {
  RandomStream random(seed, RandomStreamId::kOdometry);
  std::vector<Eigen::Matrix3d> information;
  for (const GraphEdge& edge : graph.edges)
    if (edge.kind == EdgeKind::kLoop) information.push_back(edge.information);
  const auto n = static_cast<double>(graph.poses.size());
  while (count > 0) {
    GraphEdge edge;
    edge.from = static_cast<NodeId>(random.uniform(0, n));
    edge.to = static_cast<NodeId>(random.uniform(0, n));
    if (edge.from > edge.to) std::swap(edge.from, edge.to);
    edge.kind = EdgeKind::kLoop;
    edge.T_from_to = kind == FalseLoops::kSamePlace
                         ? Pose2(0.3 * random.normal(), 0.3 * random.normal(), kPi / 18 * random.normal())
                         : Pose2(random.uniform(-size_m, size_m), random.uniform(-size_m, size_m), random.uniform(-kPi, kPi));
    if (edge.to - edge.from < 2) continue;
    const Pose2 T = between(truth[static_cast<std::size_t>(edge.from)], truth[static_cast<std::size_t>(edge.to)]);
    if (distance(T, edge.T_from_to) < 1 && std::abs(wrap_angle(T.heading - edge.T_from_to.heading)) < 0.5) continue;
    edge.information = information[static_cast<std::size_t>(random.uniform(0, static_cast<double>(information.size())))];
    edge.id = static_cast<EdgeId>(graph.edges.size());
    graph.edges.push_back(edge);
    --count;
  }
}

}  // namespace modslam::test
