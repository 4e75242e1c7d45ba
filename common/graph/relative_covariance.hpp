// SPDX-License-Identifier: BSD-3-Clause
/// @file How well the graph knows one node relative to another.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "common/graph/pose_graph.hpp"

namespace modslam {

/// Covariance of every node's pose relative to `source`, in the frame of `source` (order x y heading), composed along the best
/// chain of edges to it (Dijkstra, least position variance). An upper bound of the exact marginal: parallel chains are not combined.
/// Nodes that cannot be reached have a huge one. Cost O(E log N).
class RelativeCovariance {
 public:
  /// @param targets the nodes that will be asked for; the search ends when it has them. Empty: all nodes.
  RelativeCovariance(const std::vector<Pose2>& poses, const std::vector<const GraphEdge*>& edges, NodeId source,
                     const std::vector<NodeId>& targets = {});
  const Eigen::Matrix3d& operator[](NodeId id) const { return covariance_[static_cast<std::size_t>(id)]; }

 private:
  std::vector<Eigen::Matrix3d> covariance_;
};

/// The same without the bound, by node: marginal covariances in the linearised graph, in the frame of `source`. Costs a factorisation and a
/// selected inversion. Nodes that nothing ties to `source` have a huge one.
std::vector<Eigen::Matrix3d> marginal_covariances(const std::vector<Pose2>& poses, const std::vector<const GraphEdge*>& edges, NodeId source);

/// Inverse of an edge's information as covariance additive in (x, y, heading) of the frame `from`. Nearly singular
/// information is filled up so that no direction is surer than nothing and none is infinitely unsure.
Eigen::Matrix3d edge_covariance_from(const GraphEdge& edge);

}  // namespace modslam
