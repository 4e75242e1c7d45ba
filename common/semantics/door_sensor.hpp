// SPDX-License-Identifier: BSD-3-Clause
/// @file The door as a virtual sensor: beams longer than those on either side pass an opening.
/// Source: thesis algorithm 5 (width by the cosine theorem). We differ: both scan directions are
/// walked, so that either jamb may be the nearer one, and a jamb pair is kept instead of sampled
/// points.
#pragma once
#include <vector>

#include "common/scan/scan.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

/// Jamb to jamb, base frame.
using JambPair = Segment;

/// @param depth_m  how much longer than the jambs a beam must be to count as passing.
std::vector<JambPair> sense_doors(const Scan& scan, const SensorInfo& sensor, double depth_m,
                                  double min_width_m, double max_width_m, double range_limit_m);

}  // namespace modslam
