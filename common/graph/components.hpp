// SPDX-License-Identifier: BSD-3-Clause
/// @file Which parts of a graph are tied together. A robot that was carried away begins a part of its own; only a break edge, which says nearly nothing, leads there.
#pragma once
#include <vector>

#include "common/graph/types.hpp"

namespace modslam {

/// A kilometre and thirty radians: keeps the graph in one piece for its solver and decides nothing.
inline Eigen::Matrix3d break_information() { return Eigen::Vector3d(1e-6, 1e-6, 1e-3).asDiagonal(); }
inline bool is_break(const GraphEdge& edge) { return edge.kind == EdgeKind::kSequence && edge.information.trace() < 0.01; }

/// For each node the lowest id that edges other than breaks tie it to.
std::vector<NodeId> components(std::size_t nodes, const std::vector<const GraphEdge*>& edges);

}  // namespace modslam
