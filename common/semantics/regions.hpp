// SPDX-License-Identifier: BSD-3-Clause
/// @file Regions of seen floor, cut apart by walls and doors: which places belong together, before
/// their outline is drawn.
#pragma once
#include <opencv2/core.hpp>
#include <vector>

#include "common/semantics/config.hpp"
#include "common/semantics/evidence.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

/// A dense piece of the map: row 0 lowest y, pixel (row, col) covers the cell (col + ix0, row +
/// iy0) of the free-space grid.
struct Raster {
  int ix0 = 0, iy0 = 0;
  double resolution_m = 0.1;
  cv::Mat seen;    ///< CV_8U 255: floor or furniture that beams have reached
  cv::Mat labels;  ///< CV_32S 0: no region, else 1, 2, ...
  int regions = 0;

  Eigen::Vector2d to_pixel(
      const Eigen::Vector2d& p) const {  ///< continuous; pixel centres at whole numbers
    return (p / resolution_m).array() - Eigen::Array2d(ix0 + 0.5, iy0 + 0.5);
  }
  Eigen::Vector2d to_map(const Eigen::Vector2d& pixel) const {
    return ((pixel.array() + Eigen::Array2d(ix0 + 0.5, iy0 + 0.5)) * resolution_m).matrix();
  }
  /// 0 outside.
  int label_at(const Eigen::Vector2d& p) const;
};

/// What was seen; regions is still 0. @return an empty raster when nothing was.
Raster seen_floor(const Evidence& evidence);

/// Labels connected seen floor between `barriers`. Leaks narrower than 0.4 m are held.
void label_regions(Raster& raster, const std::vector<Segment>& barriers, double min_area_m2);

}  // namespace modslam
