// SPDX-License-Identifier: BSD-3-Clause
/// @file Whether walls end where a map says, and as surely as it says.
#pragma once
#include <vector>

#include "common/evaluation/semantic_map.hpp"
#include "common/evaluation/statistics.hpp"

namespace modslam {

/// A straight stretch of a wall's side that no other wall covers: it ends at a corner, at a jamb, or where another wall stands before it.
struct WallFace {
  Eigen::Vector2d a, b;
};
std::vector<WallFace> true_faces(const std::vector<MapWall>& walls);

/// Of the ends of found walls that lie on a true face, within 0.1 m and 10 degrees.
struct WallEndScores {
  std::size_t told = 0;        ///< ends that the map says were seen
  std::size_t on_face = 0;     ///< of these, ends of what is a true face; the others are furniture's, say
  Statistics along_m;          ///< absolute errors of those on a face, along it
  Statistics across_m;         ///< and across it
  double along_within = 0, across_within = 0;   ///< share of them within two of the told standard deviations (0: never right); 0.95 when errors are normal
};
WallEndScores score_wall_ends(const SemanticMap& found, const SemanticMap& truth);

}  // namespace modslam
