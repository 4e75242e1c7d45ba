// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "common/config/visitor.hpp"

namespace modslam {

struct SemanticsConfig {
  static constexpr const char* kTable = "semantics";
  double resolution_m = 0.05;
  double range_limit_m = 15.0;
  double wall_min_m = 0.5;
  double island_max_m = 5.5;
  double door_min_m = 0.6;
  double door_max_m = 2.6;
  double room_min_m2 = 1.5;
  double enclosed_min = 0.7;
  double publish_s = 2.0;
  double redraw_m = 0.02;
  double redraw_rad = 0.004;

  void visit(ConfigVisitor& v) {
    v.number("resolution_m", resolution_m, 0.02, 0.2, "m", "Side of a cell of the evidence grid.");
    v.number("range_limit_m", range_limit_m, 1, 100, "m",
             "Beams count as evidence up to this length.");
    v.number("wall_min_m", wall_min_m, 0.2, 5, "m", "Shorter straight pieces are no walls.");
    v.number("island_max_m", island_max_m, 0, 50, "m",
             "Free-standing things up to this size are objects, however straight their sides.");
    v.number("door_min_m", door_min_m, 0.3, 2, "m", "Narrower openings are no doors.");
    v.number("door_max_m", door_max_m, 0.5, 6, "m", "Wider openings are no doors.");
    v.number("room_min_m2", room_min_m2, 0.2, 100, "m2", "Smaller regions are no rooms.");
    v.number(
        "enclosed_min", enclosed_min, 0, 1, "",
        "Share of a room's outline that must be wall, door or furniture instead of unseen space.");
    v.number("publish_s", publish_s, 0, 60, "s",
             "Message time between two publications of the semantic map.");
    v.number("redraw_m", redraw_m, 0, 1, "m",
             "Scans that moved less are left as inserted until the end.");
    v.number("redraw_rad", redraw_rad, 0, 1, "rad",
             "Scans that turned less are left as inserted until the end.");
  }
};

}  // namespace modslam
