// SPDX-License-Identifier: BSD-3-Clause
/// @file What a differential drive does when its wheels roll.
#pragma once
#include "common/geometry/pose2.hpp"

namespace modslam {

/// Motion along an arc of length `distance_m` [m] that turns by `turn_rad` [rad], in the frame
/// where it starts. Exact for constant curvature.
inline Pose2 arc_motion(double distance_m, double turn_rad) {
  const double half = turn_rad / 2;
  const double chord_share = std::abs(half) < 1e-4 ? 1.0 - half * half / 6 : std::sin(half) / half;
  const double chord_m = distance_m * chord_share;
  return {chord_m * std::cos(half), chord_m * std::sin(half), wrap_angle(turn_rad)};
}

}  // namespace modslam
