// SPDX-License-Identifier: BSD-3-Clause
/// @file Two rooms of 8 x 8 m, one door between them, a corridor below with a door to each, a pillar in each room.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "common/scan/scan.hpp"

namespace modslam::test {

using Segment = std::array<double, 4>;  ///< x0 y0 x1 y1 [m], world

struct SyntheticBuilding {
  std::vector<Segment> walls, doors, pillars;  ///< of a pillar: its lower left and upper right corner
};
const SyntheticBuilding& synthetic_building();

/// 181 beams over 180 degrees, exact, to 30 m.
Scan scan_building(const Pose2& T_world_laser, std::int64_t utime);

/// The building as GeoJSON (walls, doors and rooms, world coordinates).
std::string synthetic_world_geojson();

}  // namespace modslam::test
