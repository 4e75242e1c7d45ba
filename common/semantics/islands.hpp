// SPDX-License-Identifier: BSD-3-Clause
/// @file Small connected pieces of a raster around where it changed.
#pragma once
#include <functional>

#include "common/semantics/boxes.hpp"

namespace modslam {

/// Small connected set of cells that does not touch the rim of the raster.
struct Island {
  cv::Rect box;     ///< in the whole raster
  cv::Mat1b mask;   ///< of the size of the box
  int cells = 0;
};

/// Larger sets are no islands, however they end. Cells.
struct IslandLimits {
  int longest;        ///< in x and y
  int most_cells;
  int connectivity;   ///< 4 or 8
};

/// Visits the islands of `mask`, whose cells are 0 or 255, that meet or touch `changed`. The mask must stay as it is meanwhile.
void each_island(const cv::Mat1b& mask, const Boxes& changed, const IslandLimits& limits, const std::function<void(const Island&)>& visit);

}  // namespace modslam
