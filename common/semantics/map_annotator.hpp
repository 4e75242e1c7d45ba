// SPDX-License-Identifier: BSD-3-Clause
/// @file A finished grid map through the same eyes as a run: a virtual laser looks around from places all over its floor.
#pragma once
#include "common/maps/mosaic.hpp"
#include "common/semantics/known_space.hpp"
#include "common/semantics/opening_model.hpp"
#include "common/semantics/semantics_config.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct AnnotatedMap {
  SemanticLayers layers;
  KnownSpace space;   ///< the map in cells of 0.05 m
};

/// Share of the floor's rim that lies open to the unexplored world around the map: no wall within 0.15 m. Unknown patches inside, as under
/// furniture, do not count.
double open_rim(const KnownSpace& space);

/// A map is finished when next to nothing of its rim is open.
OpeningModel::Kind kind_of(const KnownSpace& space);

/// Ids count from 1.
AnnotatedMap annotate(const MapImage& map, const SemanticsConfig& config);

}  // namespace modslam
