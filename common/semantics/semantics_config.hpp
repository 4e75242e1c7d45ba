// SPDX-License-Identifier: BSD-3-Clause
/// @file The table [semantics].
#pragma once
#include <string>

#include "common/config/visitor.hpp"

namespace modslam {

struct SemanticsConfig {
  static constexpr const char* kTable = "semantics";
  double publish_s = 3.0;
  double redraw_m = 0.03;
  double redraw_rad = 0.006;
  double range_limit_m = 20.0;
  double line_min_m = 0.5;
  double wall_min_m = 0.6;
  std::int64_t wall_sightings = 2;
  double opening_max_m = 3.5;
  double opening_probability = 0.5;
  std::string opening_trees;
  double door_min_m = 0.6;
  double door_max_m = 1.7;
  double room_min_m2 = 1.5;
  double room_enclosed = 0.6;
  double room_explored = 0.5;
  double object_max_m2 = 14.0;

  void visit(ConfigVisitor& v) {
    v.number("publish_s", publish_s, 0, 600, "s", "Time between two publications of the semantic map.");
    v.number("redraw_m", redraw_m, 0, 1, "m", "Scans that moved less keep their place in the evidence until the end.");
    v.number("redraw_rad", redraw_rad, 0, 1, "rad", "Scans that turned less keep their place in the evidence until the end.");
    v.number("range_limit_m", range_limit_m, 1, 100, "m", "Longer beams say nothing of walls.");
    v.number("line_min_m", line_min_m, 0.1, 5, "m", "Shortest straight piece of one scan.");
    v.number("wall_min_m", wall_min_m, 0.1, 10, "m", "Shortest wall.");
    v.integer("wall_sightings", wall_sightings, 1, 100, "", "Scans that must have seen each stretch of a wall.");
    v.number("opening_max_m", opening_max_m, 0.5, 10, "m", "Widest opening at which the floor is cut into rooms.");
    v.number("opening_probability", opening_probability, 0.01, 0.99, "", "How sure an opening must part two rooms.");
    v.text("opening_trees", opening_trees, "File with other trees that judge openings (`./run.sh train semantics` writes such); empty: the built-in ones, for maps of a robot and for finished ones.");
    v.number("door_min_m", door_min_m, 0.2, 5, "m", "Narrowest door.");
    v.number("door_max_m", door_max_m, 0.3, 10, "m", "Widest door; wider openings part rooms without being doors.");
    v.number("room_min_m2", room_min_m2, 0.2, 100, "m^2", "Smallest room.");
    v.number("room_enclosed", room_enclosed, 0, 1, "", "Share of a room's outline that must lie on walls or openings.");
    v.number("room_explored", room_explored, 0, 1, "", "Share of a room's area that must have been seen.");
    v.number("object_max_m2", object_max_m2, 0.01, 1000, "m^2", "Largest free-standing thing that is an object, not a block of building.");
  }
};

}  // namespace modslam
