// SPDX-License-Identifier: BSD-3-Clause
/// @file Places along a path as a hidden Markov chain: a single strange scan does not make a doorway of the middle of a room.
#pragma once
#include <vector>

#include "common/places/place_model.hpp"

namespace modslam {

/// How sure each kind is at each node of a path, given what was seen at all of them (forward and backward pass).
/// @param told  likelihood of what else is known of each node, kind by kind; of those beyond its end nothing is.
std::vector<PlaceConfidence> smooth_places(const std::vector<PlaceConfidence>& seen, const PlaceTransitions& transitions,
                                           const std::vector<PlaceConfidence>& told);

/// What the semantic map says of each node, as likelihoods: where the node lies in it, and what was seen from the other nodes of the same room, which is a
/// room or a corridor as a whole.
std::vector<PlaceConfidence> told_by_map(const std::vector<PlaceConfidence>& seen, const std::vector<PlaceOnMap>& on_map, const PlaceModel& model);

}  // namespace modslam
