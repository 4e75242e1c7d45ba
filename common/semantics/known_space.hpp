// SPDX-License-Identifier: BSD-3-Clause
/// @file What is known of the floor, as one raster for the room and object finders.
#pragma once
#include <opencv2/core.hpp>

#include "common/maps/mosaic.hpp"
#include "common/maps/occupancy_map.hpp"
#include "common/semantics/boxes.hpp"

namespace modslam {

struct KnownSpace {
  double resolution_m = 0.1;
  Eigen::Vector2d origin_m{0, 0};  ///< lower left corner of the lattice's cell (0, 0): for a growing map the map's origin
  cv::Point corner{0, 0};          ///< of the raster in the lattice: its cell (column 0, row 0); row 0 lowest y
  cv::Mat1b occupancy;             ///< 0 unknown, below 128 free, else occupied

  explicit KnownSpace(double resolution = 0.05) : resolution_m(resolution) {}
  /// The part of a finished map around what is known, in cells of `resolution_m`: a finer map's cell is occupied where any of its cells is.
  KnownSpace(const MapImage& map, double resolution_m);

  /// Takes tiles of a growing map over. The raster grows by whole squares of kFrameCells. @return where the answer for a cell
  /// changed; the first time all of it.
  Boxes update(const OccupancyMap& map, const std::set<OccupancyMap::TileIndex>& tiles);

  bool empty() const { return occupancy.empty(); }
  /// Places are rounded on the lattice, whatever part of it the raster covers.
  cv::Point cell(const Eigen::Vector2d& p) const {
    return cv::Point(static_cast<int>(std::floor((p.x() - origin_m.x()) / resolution_m)), static_cast<int>(std::floor((p.y() - origin_m.y()) / resolution_m))) - corner;
  }
  /// A place given in cells of the raster [m]: whole numbers are lower left corners.
  Eigen::Vector2d place(double x, double y) const { return origin_m + resolution_m * Eigen::Vector2d(x + corner.x, y + corner.y); }
  bool inside(const cv::Point& c) const { return c.x >= 0 && c.y >= 0 && c.x < occupancy.cols && c.y < occupancy.rows; }
  bool is_free(const cv::Point& c) const { return inside(c) && occupancy(c) > 0 && occupancy(c) < 128; }
  bool is_occupied(const cv::Point& c) const { return inside(c) && occupancy(c) >= 128; }
  /// Centre of a cell [m].
  Eigen::Vector2d centre(const cv::Point& c) const { return place(c.x + 0.5, c.y + 0.5); }
  cv::Rect frame() const { return {corner, occupancy.size()}; }  ///< in the lattice
};

/// The frame stands on multiples of this many cells, so that blocks of the plan are the same in every frame.
constexpr int kFrameCells = 256, kFrameMargin = 160;

/// Outer ring of a mask's region as a polygon; holes of at least `min_hole_m2` are joined to it by a cut of no width.
/// Corners that stand out less than `tolerance_m` are left out.
std::vector<Eigen::Vector2d> outline_of(const cv::Mat1b& mask, const KnownSpace& space, double min_hole_m2, double tolerance_m);

/// Cells of the outer rims of a mask's regions; they have the mask's hull.
std::vector<cv::Point> rim_cells(const cv::Mat1b& mask);

/// Diameter of the largest disc inside the mask.
double thickness_m(const cv::Mat1b& mask, double resolution_m);

double polygon_area_m2(const std::vector<Eigen::Vector2d>& outline);

}  // namespace modslam
