// SPDX-License-Identifier: BSD-3-Clause
/// @file Which loops of a whole graph to believe, when many of them may be wrong.
///
/// 1. Loops that tell the same story as others nearby, judged along the driven way, are believed first (PCM, see consistency.hpp).
/// 2. They are optimised with graduated non-convexity, which drops those that contradict the rest (GNC-TLS; Yang, Antonante,
///    Tzoumas, Carlone, RA-L 2020).
/// 3. Every other loop is asked whether it agrees with the graph so far; it comes in or goes out, until nothing changes. Where the
///    graph is unsure, a loop may differ as far as the graph's own marginal covariance allows, as long as that is not far.
/// Sequence edges are never doubted.
#pragma once
#include "common/graph/sparse_optimizer.hpp"

namespace modslam {

struct RobustOptions {
  /// Chi-square (3 degrees of freedom) beyond which a loop is not believed: 99.9 %. Where the believed loops agree far better than
  /// their information says, the limit comes down with them.
  double chi2_limit = 16.27;
  OptimizeOptions optimize{100, 1e-8, 0.0};
};

struct RobustResult {
  std::vector<std::size_t> refused;  ///< indices of edges, ascending
  std::size_t supported = 0;         ///< loops that others nearby confirmed along the driven way
  double chi2_limit = 0;             ///< the one that was used in the end
  double chi2_after = 0;             ///< over the edges that are believed
  int rounds = 0;                    ///< optimisations
};

/// Moves the poses to the optimum of the believed edges.
RobustResult optimize_robustly(PoseGraph& graph, const RobustOptions& options);

/// Graduated non-convexity with truncated least squares from the present poses.
/// @return weight of each edge, 0 or 1; those of sequence edges are 1.
EdgeWeights graduate(PoseGraph& graph, double chi2_limit, const OptimizeOptions& options, int* rounds = nullptr);

}  // namespace modslam
