// SPDX-License-Identifier: BSD-3-Clause
/// @file Places along a path as a hidden Markov chain: a single strange scan does not make a doorway of the middle of a room.
#pragma once
#include <vector>

#include "common/places/place_model.hpp"

namespace modslam {

/// How sure each kind is at each node of a path, given what was seen at all of them (forward and backward pass).
std::vector<PlaceConfidence> smooth_places(const std::vector<PlaceConfidence>& seen, const PlaceTransitions& transitions);

}  // namespace modslam
