// SPDX-License-Identifier: BSD-3-Clause
/// @file The floor that rooms are made of: what was seen free, with the things that stand in it taken away.
#pragma once
#include "common/semantics/known_space.hpp"

namespace modslam {

struct Floor {
  cv::Mat1b open;         ///< 255: floor. Small islands (chairs, pillars, tables) count as floor
  cv::Mat1f clearance;    ///< [cells] from what is not floor
  cv::Mat1b solid;        ///< 255: something was hit there, islands or not
  double resolution_m = 0.05;
};

/// Islands of at most `island_max_m2` are taken away, except long thin ones: these are pieces of wall between doors.
Floor make_floor(const KnownSpace& space, double island_max_m2);

}  // namespace modslam
