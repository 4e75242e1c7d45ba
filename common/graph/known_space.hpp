// SPDX-License-Identifier: BSD-3-Clause
/// @file Space that the graph covers well enough: there the robot hangs on an old node instead of making a new one.
///
/// Nodes are made while a place has few of them. Once it is full, the scan is matched against those that are there, and the motion
/// since the last one counts as measured between old nodes (Johannsson, Kaess, Fallon, Leonard, ICRA 2013), where it says more than the
/// graph knows already (Ila, Porta, Andrade-Cetto, T-RO 2010). So nodes and edges grow with the space that was seen, not with time.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "common/graph/types.hpp"

namespace modslam {

/// Nodes taken within 0.6 m of a pose and within 0.75 rad of its heading, the nearest first (a radian counts half a metre).
std::vector<NodeId> nodes_in_reach(const std::vector<Pose2>& T_map_node, const Pose2& T_map_base);

/// A robot's place relative to a node; covariance additive in (x, y, heading) of the node's frame.
struct Anchorage {
  NodeId node = 0;
  Pose2 T_node_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Where a scan says the robot is, relative to a node. Information in the robot's frame, zero where the scan saw nothing.
struct AnchorFix {
  Pose2 T_node_base;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

struct Localized {
  bool shows_nothing_new = false;  ///< the scan fits what the nodes saw, whether or not it says where it was taken
  std::optional<AnchorFix> fix;
};

/// Matches the newest scan against the scans of `known`.
/// @param expected where the graph has the robot relative to known.front().
using Localize = std::function<Localized(const std::vector<NodeId>& known, const Anchorage& expected)>;

/// The place that expectation and fix agree on, or nothing when they contradict each other.
std::optional<Anchorage> combine(const Anchorage& expected, const AnchorFix& fix);

/// The edge from the node that the robot came from to the one it now hangs on: the way there, and the fix seen backwards.
GraphEdge passing_edge(const Anchorage& came, NodeId node, const AnchorFix& fix);

}  // namespace modslam
