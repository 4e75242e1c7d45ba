// SPDX-License-Identifier: BSD-3-Clause
/// @file A proof that no other arrangement of the poses has a smaller chi2.
///
/// Idea (SE-Sync: Rosen, Carlone, Bandeira, Leonard, IJRR 2019): with headings as complex numbers r of length 1 and positions t, a cost
/// x* Q x in x = (r, t) has at x the multipliers L_i = Re(conj(r_i) (Q x)_i), and for every other y with |r_i| = 1
///     y* Q y = sum L_i + y* (Q - L) y,   sum L_i = x* Q x where the positions of x are the best for its headings.
/// If Q - L + d I has a Cholesky factor, nothing lies lower than sum L_i - n d.
///
/// Their cost wants equal information along x and y and measures a turn by its chord. Ours is chi2 as g2o defines it, so Q is here a
/// cost that lies nowhere above chi2 and touches it at the given poses: what an edge's information has beyond its smallest value
/// along a line is replaced by its tangent, and the square of a turn by a cosine through the same point with the same slope.
/// The proof is then one for chi2 itself. Strongly unequal information can make it fail at a true optimum; it never proves a false one.
#pragma once
#include "common/graph/pose_graph.hpp"

namespace modslam {

struct Certificate {
  bool is_optimal = false;    ///< lower_bound is within 1e-6 of chi2
  double chi2 = 0;            ///< of the given poses
  double lower_bound = 0;     ///< no poses have less; 0 is the least that is known of every graph
  double min_eigenvalue = 0;  ///< of Q - L without the positions (their Schur complement): 0 up to rounding at a proven optimum
};

/// @param graph  at a minimum of chi2; elsewhere the bound is just poor. Cost: a few factorisations.
Certificate certify(const PoseGraph& graph);

}  // namespace modslam
