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

/// A robot that has swept a field of `side` x `side` places 1 m apart, lane after lane, and sees the neighbour in the lane before from
/// each place: many loops. All edges have noise of `sigma` (m, rad); poses as odometry has them.
inline PoseGraph swept_field(int side, double sigma, std::uint64_t seed, std::vector<Pose2>* truth = nullptr) {
  RandomStream random(seed, RandomStreamId::kOdometry);
  std::vector<Pose2> T_map;
  for (int lane = 0; lane < side; ++lane)
    for (int k = 0; k < side; ++k) T_map.push_back({lane % 2 ? side - 1.0 - k : k, double(lane), lane % 2 ? kPi : 0.0});
  PoseGraph graph;
  const auto add = [&](NodeId from, NodeId to, EdgeKind kind) {
    const Pose2 T = between(T_map[static_cast<std::size_t>(from)], T_map[static_cast<std::size_t>(to)]);
    graph.edges.push_back(edge(from, to, T * Pose2(sigma * random.normal(), sigma * random.normal(), sigma * random.normal()), kind));
    graph.edges.back().information = Eigen::Matrix3d::Identity() / (sigma * sigma);
    graph.edges.back().id = static_cast<EdgeId>(graph.edges.size()) - 1;
  };
  const auto n = static_cast<NodeId>(T_map.size());
  for (NodeId k = 0; k + 1 < n; ++k) add(k, k + 1, EdgeKind::kSequence);
  for (NodeId k = side; k < n; ++k) {
    const NodeId lane = k / side, before = lane * side - 1 - k % side;
    if (before + 1 < k) add(before, k, EdgeKind::kLoop);
  }
  graph.poses.resize(T_map.size());
  initialize_from_odometry(graph);
  if (truth) *truth = T_map;
  return graph;
}

}  // namespace modslam::test
