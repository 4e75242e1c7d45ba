// SPDX-License-Identifier: BSD-3-Clause
/// @file Doors: gaps between walls that many scans have looked through (evidence over time of the door sensor, thesis 3.4.3).
#pragma once
#include <vector>

#include "common/semantics/door_sensor.hpp"
#include "common/semantics/known_space.hpp"
#include "common/semantics/wall_map.hpp"

namespace modslam {

struct DoorMapOptions {
  double min_width_m = 0.6, max_width_m = 1.7;
  int min_sightings = 4;
  double centre_m = 0.35;       ///< a sighting supports a gap whose centre is this near
  double merge_m = 0.45;        ///< gaps of a wall's two faces are one door
  double min_free = 0.7;        ///< share of the gap that must be seen free
};

/// @param sightings in the map frame. A door is a gap between two walls of one band, or between a wall's end and a wall that crosses its
/// line, that is free and supported by sightings.
std::vector<Door> find_doors(const std::vector<WallBand>& bands, const std::vector<DoorSighting>& sightings,
                             const KnownSpace& space, const DoorMapOptions& options);

}  // namespace modslam
