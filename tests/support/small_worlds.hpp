// SPDX-License-Identifier: BSD-3-Clause
/// @file Worlds small enough to know every distance by heart.
#pragma once
#include <vector>

#include "common/world/world.hpp"

namespace modslam {

/// A room of 4 x 4 m inside, walls 0.2 m thick, the origin in its middle; a box of 1 x 1 m in its
/// upper right corner; a route from (-1, -1) along three sides of a square.
inline World square_room() {
  World world;
  world.name = "square room";
  const double m = 2.1;  // middle line of the walls
  world.walls = {{"south", {-m, -m}, {m, -m}, 0.2},
                 {"east", {m, -m}, {m, m}, 0.2},
                 {"north", {m, m}, {-m, m}, 0.2},
                 {"west", {-m, m}, {-m, -m}, 0.2}};
  world.objects = {{"box", "box", {{1, 1}, {2, 1}, {2, 2}, {1, 2}}}};
  world.routes = {{"sides", {{-1, -1}, {1, -1}, {1, 0.5}, {-1, 0.5}}, 0.5, 0.3, false},
                  {"corners", {{-1, -1}, {1, -1}, {1, 0.5}, {-1, 0.5}}, 0.5, 0.0, true},
                  {"into the wall", {{0, 0}, {3, 0}}, 0.5, 0.3, false},
                  {"from the wall", {{-1.9, 0}, {1, 0}}, 0.5, 0.3, false}};
  world.start = {-1, -1};
  return world;
}

}  // namespace modslam
