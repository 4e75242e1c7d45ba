// SPDX-License-Identifier: BSD-3-Clause
/// @file Objects: what stands free in known floor. Cars and pillars are among them; their faces are no walls.
#pragma once
#include <vector>

#include "common/semantics/floor.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct ObjectMap {
  struct Footprint {
    Island island;                 ///< what it covers
    Island whole;                  ///< that and the pieces of wall it hangs on
    Object object;
  };
  std::vector<Footprint> objects;  ///< from top to bottom, from left to right
  cv::Mat1b mask;                  ///< cells that belong to an object, on the grid of the known space

  void grow(const Growth& growth);
};

/// Keeps the objects in step with a space that changed. @param islands  those of not-free cells, surrounded by free floor, that met the change: some are
/// objects. @return where the mask changed.
Boxes update_objects(ObjectMap& map, const KnownSpace& space, const Floor& floor, const Boxes& changed, const std::vector<Island>& islands);

}  // namespace modslam
