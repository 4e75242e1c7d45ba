// SPDX-License-Identifier: BSD-3-Clause
/// @file A finished grid map through the same eyes as a run: a virtual laser looks around from places all over its floor.
#pragma once
#include "common/maps/mosaic.hpp"
#include "common/semantics/known_space.hpp"
#include "common/semantics/semantics_config.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct AnnotatedMap {
  SemanticLayers layers;
  KnownSpace space;   ///< the map in cells of 0.05 m
};

/// Ids count from 1.
AnnotatedMap annotate(const MapImage& map, const SemanticsConfig& config);

}  // namespace modslam
