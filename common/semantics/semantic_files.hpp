// SPDX-License-Identifier: BSD-3-Clause
/// @file The semantic map as files: GeoJSON (the schema of runs, of annotated maps and of true worlds) and SVG.
#pragma once
#include <string>

#include "common/semantics/types.hpp"

namespace modslam {

/// FeatureCollection in map metres, one feature a thing (docs/architecture.md has the schema). Numbers that are not finite become 0.
std::string semantic_geojson(const SemanticLayers& layers);

/// A drawing in map metres, y up, 40 pixels a metre.
std::string semantic_svg(const SemanticLayers& layers);

}  // namespace modslam
