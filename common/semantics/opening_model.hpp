// SPDX-License-Identifier: BSD-3-Clause
/// @file How sure an opening parts two rooms: gradient-boosted trees over its features.
#pragma once
#include <array>

#include "common/semantics/openings.hpp"

namespace modslam {

/// 0..1. The trees stand in opening_trees.inc; `./run.sh train semantics` makes them anew.
double opening_probability(const std::array<float, kOpeningFeatures>& features);

}  // namespace modslam
