// SPDX-License-Identifier: BSD-3-Clause
/// @file What a pose graph is made of.
#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "common/geometry/pose2.hpp"

namespace modslam {

using NodeId = std::int64_t;
using EdgeId = std::int64_t;

enum class EdgeKind : std::int8_t { kSequence = 1, kLoop = 2 };

/// "Node `to` was seen at T_from_to from node `from`". Error e = (x, y, heading) of
/// inverse(T_from_to) * inverse(T_map_from) * T_map_to; cost e' * information * e (g2o's EDGE_SE2).
struct GraphEdge {
  EdgeId id = 0;
  NodeId from = 0, to = 0;
  EdgeKind kind = EdgeKind::kSequence;
  Pose2 T_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< order x y heading; may be singular
};

}  // namespace modslam
