// SPDX-License-Identifier: BSD-3-Clause
/// @file The path of every scan, from the path of the graph's nodes.
///
/// While the robot drives, a scan's pose is kept relative to a node: T_map_base = T_map_node *
/// T_node_base. Now and then a scan gets a new place: it becomes a node itself or is found among old
/// ones. Between where it hung before (T_before_base) and its new place lies a difference, because it
/// was found and because nodes move later; the path would jump there. So the difference C =
/// (T_map_before * T_before_base)^-1 * T_map_base is spread over the scans since the last new place,
/// in proportion to the travel: T_map_base = T_map_node * T_node_base * C^share, share 0 at that
/// place and 1 at the new one.
#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "common/graph/types.hpp"

namespace modslam {

/// A scan's pose as it was estimated when it came.
struct TrackedPose {
  std::int64_t utime = 0;
  NodeId node = -1;  ///< that it hangs on; -1: none yet
  Pose2 T_node_base;
  Pose2 T_map_base;         ///< used where the node is not known
  NodeId node_before = -1;  ///< of a scan with a new place: the node that it hung on before
  Pose2 T_before_base;
};

/// One pose T_map_base for each of `tracked`, in their order.
/// @param T_map_node  where the nodes are in the end.
std::vector<Pose2> final_path(const std::vector<TrackedPose>& tracked,
                              const std::map<NodeId, Pose2>& T_map_node);

/// A scan that became a node is known from the graph, to the bit, also where the pose that told of it was lost: puts it in, so that the
/// path before it is no worse for that. What comes after an old node was found again cannot be put in: its scans stay where they were tracked.
void add_lost_nodes(std::vector<TrackedPose>& tracked, const std::map<NodeId, std::int64_t>& node_utimes,
                    const std::map<EdgeId, GraphEdge>& edges);

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
