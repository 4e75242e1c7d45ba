// SPDX-License-Identifier: BSD-3-Clause
/// @file The floor that rooms are made of: what was seen free, with the things that stand in it taken away.
#pragma once
#include "common/semantics/islands.hpp"
#include "common/semantics/known_space.hpp"

namespace modslam {

struct Floor {
  static constexpr double kFarthest_m = 2.0;

  cv::Mat1b open;         ///< 255: floor. Small islands (chairs, pillars, tables) count as floor
  cv::Mat1f clearance;    ///< [cells] from what is not floor, at most kFarthest_m
  cv::Mat1b solid;        ///< 255: something was hit there, islands or not
  double resolution_m = 0.05;
  cv::Mat1b closed, things, swept, specks;  ///< not seen free; the islands; the floor with loose patches; these patches

  void allocate(const cv::Size& frame);
  void grow(const Growth& growth);
};

/// Where each raster of the floor changed.
struct FloorChange {
  Boxes open, clearance, solid;
  std::vector<Island> islands;  ///< of what is not free, those that met the change
};

/// Islands of at most `island_max_m2` are taken away, except long thin ones: these are pieces of wall between doors.
Floor make_floor(const KnownSpace& space, double island_max_m2);

/// Keeps a floor in step with a space that changed within `changed`: the result is what make_floor() would give. Cost by the size of the change.
FloorChange update_floor(Floor& floor, const KnownSpace& space, double island_max_m2, const Boxes& changed);

}  // namespace modslam
