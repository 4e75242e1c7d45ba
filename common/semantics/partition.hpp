// SPDX-License-Identifier: BSD-3-Clause
/// @file The floor cut at its openings: every region is a room or a part of one that was not seen whole.
#pragma once
#include "common/semantics/openings.hpp"

namespace modslam {

/// An opening that was cut, and the regions on its two sides (left and right of a -> b; 0: none).
struct CutOpening {
  Opening opening;
  int left = 0, right = 0;
};

struct Partition {
  cv::Mat1i labels;               ///< 0: no floor; regions from 1, not all numbers are used
  std::vector<CutOpening> cuts;   ///< surest first; each parts two regions
};

/// Takes the surest openings first, none that says the same as one before. Regions that are too small to be rooms join a neighbour through
/// their least sure opening.
Partition part_floor(const Floor& floor, const KnownSpace& space, std::vector<Opening> openings, double min_probability, double min_room_m2);

}  // namespace modslam
