// SPDX-License-Identifier: BSD-3-Clause
/// @file semantic.geojson back into what it was written from.
#pragma once
#include <string>

#include "common/semantics/types.hpp"

namespace modslam {

/// Reads what semantic_geojson() writes; features of other kinds are passed over. Names longer than 200 letters are cut.
/// @throws std::runtime_error naming the feature (from 1) and what is wrong with it.
SemanticLayers parse_layers(const std::string& geojson);

}  // namespace modslam
