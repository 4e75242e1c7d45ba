// SPDX-License-Identifier: BSD-3-Clause
/// @file What a perfect semantic map of a drawn world would hold.
#pragma once
#include <array>
#include <string>

#include "common/world/world.hpp"

namespace modslam {

/// The ids of the rooms a door joins: left and right of the line from jamb a to jamb b, looked for
/// up to 0.5 m from the door's middle. "" where there is none (the outside).
std::array<std::string, 2> rooms_joined(const World& world, const WorldDoor& door);

/// The world as a semantic map: a FeatureCollection in metres, one feature a line. Walls are middle
/// lines with their `thickness_m`; a room is a corridor where its category is "corridor"; doors
/// carry the two rooms they join, null for the outside. Routes, people and the start are left out.
std::string world_truth_geojson(const World& world);

}  // namespace modslam
