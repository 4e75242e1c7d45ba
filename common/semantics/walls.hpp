// SPDX-License-Identifier: BSD-3-Clause
/// @file Walls from the evidence grid: rough pieces grown over cells of like direction, then merged
/// and fitted. Source: thesis section 3.4.1, algorithm 4. We differ: the cells keep where in them
/// beams ended and along what direction, so that pieces are grown and fitted below the cell size;
/// joined pieces are fitted to their cells instead of chosen from a box.
#pragma once
#include <vector>

#include "common/semantics/config.hpp"
#include "common/semantics/evidence.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

/// A cell of the grid as a point with a direction.
struct OrientedCell {
  int ix, iy;
  Eigen::Vector2d p;     ///< mean place where its beams ended
  double angle_rad;      ///< of the straight pieces, [0, pi)
  Eigen::Vector2d view;  ///< mean direction towards the sensors that saw it
  double weight;         ///< beams, capped
  double log_odds;       ///< of being wall rather than something else
};

/// A wall face and the cells that it stands on.
struct WallFace {
  Segment segment;         ///< was seen from its left
  std::vector<int> cells;  ///< indices into the oriented cells
  double sigma_m = 0, evidence = 0;
};

/// Cells with enough wall evidence that were not crossed far more often than hit.
std::vector<OrientedCell> oriented_cells(const Evidence& evidence);

/// Rough pieces: regions of touching cells along one line.
std::vector<WallFace> grow_faces(const std::vector<OrientedCell>& cells, double resolution_m);

/// Joins pieces on one line unless free space was seen between them; repeats until nothing joins.
/// Longest first.
/// @param hidden_gap_m  gaps up to this are bridged where nothing was seen; small ones always are.
std::vector<WallFace> merge_faces(std::vector<WallFace> faces,
                                  const std::vector<OrientedCell>& cells, const Evidence& evidence,
                                  double hidden_gap_m);

/// Grown and merged over small gaps; faces shorter than min_length_m or poorly covered are left
/// out.
std::vector<WallFace> find_faces(const std::vector<OrientedCell>& cells, const Evidence& evidence,
                                 double min_length_m);

/// Share of the way from a to b that beams have crossed.
double seen_free(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Evidence& evidence);

}  // namespace modslam
