// SPDX-License-Identifier: BSD-3-Clause
/// @file Objects: what stands free in known floor. Cars and pillars are among them; their faces are no walls.
#pragma once
#include <vector>

#include "common/semantics/floor.hpp"
#include "common/semantics/islands.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct ObjectMap {
  struct Footprint {
    Island island;
    Object object;
  };
  std::vector<Footprint> objects;  ///< from top to bottom, from left to right
  cv::Mat1b mask;                  ///< cells that belong to an object, on the grid of the known space
};

/// Islands of not-free cells, surrounded by free floor, of at most max_m2.
ObjectMap find_objects(const KnownSpace& space, const Floor& floor, double max_m2);

/// Keeps the objects in step with a floor whose `closed` or `solid` changed. @return where the mask changed.
Boxes update_objects(ObjectMap& map, const KnownSpace& space, const Floor& floor, double max_m2, const Boxes& changed);

}  // namespace modslam
