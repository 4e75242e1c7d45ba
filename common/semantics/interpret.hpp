// SPDX-License-Identifier: BSD-3-Clause
/// @file From evidence to walls, rooms, doors and objects: the same for a run and for a finished map.
#pragma once
#include <functional>
#include <vector>

#include "common/semantics/door_sensor.hpp"
#include "common/semantics/known_space.hpp"
#include "common/semantics/opening_model.hpp"
#include "common/semantics/semantics_config.hpp"
#include "common/semantics/types.hpp"
#include "common/semantics/wall_map.hpp"

namespace modslam {

/// All in the map frame.
struct SemanticEvidence {
  KnownSpace space;
  std::vector<PlacedSegments> scans;
  std::vector<DoorSighting> sightings;
  std::function<double(const Eigen::Vector2d&)> wall_log_odds;
};

/// Ids are left 0.
SemanticLayers interpret(const SemanticEvidence& evidence, const SemanticsConfig& config, const OpeningModel& model);

}  // namespace modslam
