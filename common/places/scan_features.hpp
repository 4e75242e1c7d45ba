// SPDX-License-Identifier: BSD-3-Clause
/// @file Simple numbers of what one sees around a place, after Mozos, Stachniss and Burgard (ICRA 2005): of the ranges and of the polygon
/// that their ends span. None changes when the robot turns on the spot.
#pragma once
#include <vector>

#include "common/places/panorama.hpp"

namespace modslam {

/// All in metres or pure numbers; the same count for every panorama, all finite.
std::vector<float> place_features(const Panorama& panorama);

}  // namespace modslam
