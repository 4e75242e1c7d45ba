// SPDX-License-Identifier: BSD-3-Clause
/// @file Least squares over a pose graph with a sparse factorisation whose pattern is analysed once.
#pragma once
#include <complex>

#include "common/graph/block_cholesky.hpp"
#include "common/graph/pose_graph.hpp"

namespace modslam {

/// One weight an edge, in their order; an empty list weighs all of them 1.
using EdgeWeights = std::vector<double>;

/// Serves one set of nodes and links: the poses, measurements, information and weights may change between calls, the ends of the
/// edges may not. Node 0 stands still. Not to be copied: its factorisation refers to its pattern.
class SparseOptimizer {
 public:
  explicit SparseOptimizer(const PoseGraph& graph);
  SparseOptimizer(const SparseOptimizer&) = delete;
  SparseOptimizer& operator=(const SparseOptimizer&) = delete;

  /// Gauss-Newton from the present poses; Levenberg-Marquardt takes over where a full step raises the error.
  OptimizeResult optimize(PoseGraph& graph, const OptimizeOptions& options, const EdgeWeights& weights = {});

  /// Poses from the measurements alone, whatever the present poses are: headings as complex numbers that need not have length 1, which
  /// is linear least squares, then positions for these headings, which is linear too (Carlone et al., ICRA 2015; Martinec
  /// and Pajdla, CVPR 2007). Usually in the basin of the global optimum. Nodes that no edge of positive weight holds stay.
  void initialize_chordal(PoseGraph& graph, const EdgeWeights& weights = {});

  /// Factorises the information at the present poses; marginal() speaks of these.
  void prepare_marginals(const PoseGraph& graph, const EdgeWeights& weights = {});
  /// Covariance of what the graph predicts for a measurement between two nodes, as the error of `edge` sees it (frame of the measured
  /// node, order x y heading). Exact for the linearised graph; two sweeps through the factor for each of three columns.
  Eigen::Matrix3d marginal(const PoseGraph& graph, const GraphEdge& edge) const;
  /// Covariance of every node's pose relative to node 0, additive in (x, y, heading) of the map frame; node 0's is zero.
  std::vector<Eigen::Matrix3d> marginals() const;

  const BlockPattern& pattern() const { return pattern_; }
  /// Entry of the factor that edge k touches; -1 when one of its ends is node 0.
  int entry(std::size_t k) const { return entries_[k]; }
  /// Whether that entry's row belongs to the edge's `from`.
  bool row_is_from(std::size_t k) const { return row_is_from_[k]; }

 private:
  double linearize(const PoseGraph& graph, double dcs_phi, const EdgeWeights& weights, double damping);
  void relax_headings(PoseGraph& graph, const EdgeWeights& weights) const;
  void solve_positions(PoseGraph& graph, const EdgeWeights& weights) const;

  std::vector<BlockPattern::Link> links_;  // variables of each edge: node - 1
  BlockPattern pattern_;
  std::vector<int> entries_;
  std::vector<bool> row_is_from_;
  BlockCholesky<double, 3> H_;
  Eigen::VectorXd gradient_;
};

}  // namespace modslam
