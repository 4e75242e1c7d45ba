// SPDX-License-Identifier: BSD-3-Clause
/// @file What stands on the floor and is not wall: islands, furniture, cars, pillars.
#pragma once
#include <vector>

#include "common/semantics/config.hpp"
#include "common/semantics/evidence.hpp"
#include "common/semantics/types.hpp"
#include "common/semantics/walls.hpp"

namespace modslam {

/// Walls and what only looks like one.
struct WallSplit {
  std::vector<WallFace> walls, furniture;
};

/// Faces from the evidence, parted: the sides of free-standing things up to config.island_max_m are
/// no walls (a wall piece between two doors goes on as a wall beyond them), nor are the fronts and
/// sides of what stands before a wall and hides it.
WallSplit find_walls(const Evidence& evidence, const SemanticsConfig& config);

/// Footprints of touching cells that were hit and lie on no wall. Without ids and times.
std::vector<Object> find_objects(const Evidence& evidence, const std::vector<WallFace>& walls);

}  // namespace modslam
