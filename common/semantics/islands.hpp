// SPDX-License-Identifier: BSD-3-Clause
/// @file Small connected pieces of a raster around where it changed.
#pragma once
#include <functional>

#include "common/semantics/boxes.hpp"

namespace modslam {

/// Connected set of cells that lies within a window without touching its rim.
struct Island {
  cv::Rect box;     ///< in the whole raster
  cv::Mat1b mask;   ///< of the size of the box
  int cells = 0;
};

/// Visits the islands of `mask` that meet or touch `changed` and are no longer than `longest` cells in x and y. Larger sets are none, however they end.
void each_island(const cv::Mat1b& mask, const Boxes& changed, int longest, int connectivity, const std::function<void(const Island&)>& visit);

}  // namespace modslam
