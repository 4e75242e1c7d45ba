// SPDX-License-Identifier: BSD-3-Clause
/// @file Rooms: what walls and doors enclose, where the floor was seen.
///
/// The thesis looked for cycles of wall ends; one hidden corner breaks a cycle, and cycles round unseen space are rooms too. Here known free
/// floor is flooded with walls (drawn out a little at their ends) and doors as barriers; a flooded region is a room when its outline
/// lies on walls and doors (the closed cycle), and unexplored space cannot be one because the flood never enters it.
#pragma once
#include <vector>

#include "common/semantics/known_space.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct RoomOptions {
  double min_area_m2 = 2.0;
  double wall_extension_m = 0.30;  ///< walls are drawn out so far at both ends to meet others
  double fringe_m = 0.5;           ///< shadows of furniture this deep still belong to the room
  double min_enclosed = 0.7;       ///< share of the outline that must lie on walls or doors
  double min_explored = 0.6;
};

std::vector<Room> find_rooms(const std::vector<Wall>& walls, const std::vector<Door>& doors, const KnownSpace& space,
                             const RoomOptions& options);

/// Fills in the two rooms each door joins: the ones a step to either side of its middle.
void join_rooms(std::vector<Door>& doors, const std::vector<Room>& rooms);

/// Even-odd rule.
bool contains(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p);

}  // namespace modslam
