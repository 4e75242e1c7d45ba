// SPDX-License-Identifier: BSD-3-Clause
/// @file The outline of the floor as straight edges and corners, block by block.
#pragma once
#include <vector>

#include "common/semantics/floor.hpp"

namespace modslam {

/// A corner that the floor goes round, and the outline's directions away from it. Cells.
struct Corner {
  Eigen::Vector2d p{0, 0}, before{0, 0}, after{0, 0};
  double turn_rad = 0;
};

struct Edge {
  Eigen::Vector2d a, b;
};

struct Outline {
  std::vector<Corner> corners;  ///< within the block
  std::vector<Edge> edges;      ///< within the block and up to a metre around it
};

/// Blocks are squares of so many cells, counted from the raster's corner.
constexpr int kPlanBlock = 128;

/// What lies within a metre of the block decides, nothing else.
Outline trace(const Floor& floor, const cv::Rect& block);

}  // namespace modslam
