// SPDX-License-Identifier: BSD-3-Clause
/// @file The floor cut at its openings: every region is a room or a part of one that was not seen whole.
#pragma once
#include <set>

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
  std::set<int> parking;          ///< regions that gaps between parked cars belong to
};

/// Small regions with one way in. When they are not closed in they are no more than what was seen through that way.
std::set<int> glimpses(const Partition& partition, double cell_m, double most_m2);

struct PartitionOptions {
  double min_probability = 0.5;
  double min_room_m2 = 1.5;
  double small_m2 = 5.0;
  double min_walled = 0.15;   ///< share of a small region's outline, openings left out, that lies on walls: between parked cars there are none
};

/// Takes the surest openings first, none that says the same as one before. Regions that are too small to be rooms, or have too little wall
/// around them, join a neighbour through their least sure opening. No walls given: none are asked for.
Partition part_floor(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, std::vector<Opening> openings,
                     const PartitionOptions& options);

}  // namespace modslam
