// SPDX-License-Identifier: BSD-3-Clause
/// @file Which pieces of a finely cut floor are one room: clustering of a signed graph.
#pragma once
#include <vector>

namespace modslam {

/// What speaks for (weight > 0) or against two pieces being one; of several between the same two all count.
struct PieceBond {
  int p, q;
  double weight;
};

/// Joins the two clusters with the strongest bond between them until no bond is positive (greedy additive edge contraction; Keuper et al.,
/// "Efficient decomposition of image and mesh graphs by lifted multicuts", ICCV 2015). One sure cut so holds two pieces apart although they also meet
/// where a cut is less than sure. @param count  pieces are 0..count-1. @return cluster of each piece, the number of one of its pieces.
std::vector<int> cluster_pieces(int count, const std::vector<PieceBond>& bonds);

}  // namespace modslam
