// SPDX-License-Identifier: BSD-3-Clause
/// @file The path of every scan, from the path of the graph's nodes.
///
/// While the robot drives, a scan's pose is kept relative to the newest node: T_map_base =
/// T_map_node * T_node_base. Nodes move later. Between node k and node k+1 lies a difference
/// between how far the robot thought it went (T_k_next) and where the two nodes stand in the end;
/// hung on node k alone, the path would jump at each node. So the difference C = T_k_next^-1 *
/// (T_map_k^-1 * T_map_next) is spread over the scans between them, in proportion to the travel:
/// T_map_base = T_map_k * T_node_base * C^share, share 0 at node k and 1 at node k+1.
#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "common/graph/types.hpp"

namespace modslam {

/// A scan's pose as it was estimated when it came.
struct TrackedPose {
  std::int64_t utime = 0;
  NodeId node = -1;  ///< newest node at that time; -1: none yet
  Pose2 T_node_base;
  Pose2 T_map_base;  ///< used where the node is not known
};

/// One pose T_map_base for each of `tracked`, in their order.
/// @param T_map_node  where the nodes are in the end.
/// @param T_from_next the measured motion from a node to the node after it (its sequence edge);
/// nodes without one get no spreading.
std::vector<Pose2> final_path(const std::vector<TrackedPose>& tracked,
                              const std::map<NodeId, Pose2>& T_map_node,
                              const std::map<NodeId, Pose2>& T_from_next);

/// Finds for each scan the pose that was estimated for it: both in file order, stamps may repeat or
/// step back.
/// @return for each scan an index into pose_utimes, or -1.
std::vector<int> match_in_order(const std::vector<std::int64_t>& scan_utimes,
                                const std::vector<std::int64_t>& pose_utimes);

/// One pose for each scan: its own, or where it has none the pose between its neighbours by scan
/// index (the nearest one before the first and after the last). Empty when no scan has a pose.
std::vector<Pose2> fill_by_index(const std::vector<int>& pose_of_scan,
                                 const std::vector<Pose2>& poses);

}  // namespace modslam
