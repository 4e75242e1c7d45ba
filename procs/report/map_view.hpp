// SPDX-License-Identifier: BSD-3-Clause
/// @file The map of a run as one SVG picture in layers that can be switched.
#pragma once
#include <string>
#include <vector>

#include "procs/report/results.hpp"
#include "procs/report/svg.hpp"

namespace modslam::report {

/// What a simulated world really looks like, in world coordinates: drawn faintly under what was
/// found.
struct WorldOutline {
  std::vector<Points> walls, doors;
};

/// @throws std::runtime_error naming the file, when it is missing or no GeoJSON FeatureCollection.
WorldOutline read_world_outline(const std::string& path);

/// The switches for the layers and the picture itself.
std::string map_view(const RunRecord& run, const Results& results, const WorldOutline* world);

}  // namespace modslam::report
