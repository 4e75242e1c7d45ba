// SPDX-License-Identifier: BSD-3-Clause
/// @file Small pose graphs.
#pragma once
#include "common/graph/pose_graph.hpp"
#include "common/world/random.hpp"

namespace modslam::test {

/// Information 100 (10 cm) and 400 (50 mrad) by default.
inline GraphEdge edge(NodeId from, NodeId to, const Pose2& T_from_to, EdgeKind kind = EdgeKind::kSequence) {
  GraphEdge out;
  out.from = from;
  out.to = to;
  out.kind = kind;
  out.T_from_to = T_from_to;
  out.information = Eigen::Vector3d(100, 100, 400).asDiagonal();
  return out;
}

/// A square of `nodes` steps of 0.5 m driven with noise (sigma_m, half of it in rad) and closed by one good loop
/// from the last node to the first. Poses as odometry has them.
inline PoseGraph square_loop(int nodes, double sigma_m, std::uint64_t seed) {
  RandomStream random(seed, RandomStreamId::kOdometry);
  PoseGraph graph;
  Pose2 T_map_true, T_map_odom;
  graph.poses.push_back({});
  for (int k = 1; k < nodes; ++k) {
    const bool corner = k % (nodes / 4) == 0;
    const Pose2 motion(0.5, 0, corner ? kPi / 2 : 0.0);
    const Pose2 noisy(motion.x + sigma_m * random.normal(), sigma_m * random.normal(),
                      motion.heading + 0.5 * sigma_m * random.normal());
    T_map_true = T_map_true * motion;
    T_map_odom = T_map_odom * noisy;
    graph.poses.push_back(T_map_odom);
    graph.edges.push_back(edge(k - 1, k, noisy));
  }
  graph.edges.push_back(edge(0, nodes - 1, T_map_true, EdgeKind::kLoop));
  for (std::size_t k = 0; k < graph.edges.size(); ++k) graph.edges[k].id = static_cast<EdgeId>(k);
  return graph;
}

}  // namespace modslam::test
