// SPDX-License-Identifier: BSD-3-Clause
/// @file Which loops of a pose graph tell the same story, judged along the driven way alone: no pose needs to be right.
///
/// Two loops i-k and j-l make a ring together with the ways i..j and k..l. When the ring closes within what its four parts are unsure
/// of, the loops are consistent (pairwise consistency: Mangelson, Dominic, Eustice, Vasudevan, ICRA 2018).
#pragma once
#include <vector>

#include "common/graph/pose_graph.hpp"

namespace modslam {

/// The driven way: sequence edges, one after the other from node 0.
class DrivenWay {
 public:
  explicit DrivenWay(const PoseGraph& graph);
  /// Motion from node a to b along the way.
  Pose2 motion(NodeId a, NodeId b) const { return between(T_start_[at(a)], T_start_[at(b)]); }
  /// Its covariance in the tangent space at node a (order x y heading). Huge where the way between them has a gap.
  Eigen::Matrix3d covariance(NodeId a, NodeId b) const;

 private:
  static std::size_t at(NodeId id) { return static_cast<std::size_t>(id); }
  std::vector<Pose2> T_start_;
  std::vector<Eigen::Matrix3d> sum_;  // of all errors up to a node, in the tangent space at the start
  std::vector<int> gaps_;             // before a node
};

/// Squared error of the ring that two loops make, in units of its covariance: chi-square with 3 degrees of freedom for true loops.
double ring_chi2(const DrivenWay& way, const GraphEdge& a, const GraphEdge& b);

/// `limit` for chi-squares of 3 degrees of freedom, brought down where the values that lie below it are much smaller than they claim to be:
/// files often carry information that is ten or a hundred times too small, and then a limit by the book lets everything pass.
/// Their median counts, times `margin` for the long tail of real data. Fewer than 10 values change nothing.
double fitted_limit(double limit, std::vector<double> chi2, double margin);

/// For each edge the loops that are consistent with it (ascending). Only loops whose ends lie within `reach` nodes of each other are
/// compared: over a long way odometry is so unsure that everything agrees with everything. Sequence edges have none.
/// @param chi2_limit  of ring_chi2. It comes down where most rings close far better than their parts claim, see fitted_limit().
std::vector<std::vector<std::size_t>> consistent_loops(const PoseGraph& graph, NodeId reach, double chi2_limit);

/// Indices of a large set of vertices that all know each other: greedy from each vertex in turn, most friends first. The largest one
/// is found in all but contrived cases. @param friends  symmetric, ascending lists.
std::vector<std::size_t> large_clique(const std::vector<std::vector<std::size_t>>& friends);

}  // namespace modslam
