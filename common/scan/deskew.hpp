// SPDX-License-Identifier: BSD-3-Clause
/// @file A laser that turns its mirror while the robot drives sees every beam from another place.
#pragma once
#include "common/scan/scan.hpp"

namespace modslam {

/// The sweep as it would have been seen at once, from where the robot was at its last beam, on the same bearings.
///
/// Beams are taken to be spread evenly over the sweep and the motion over its time. Between two returns of one surface a range is interpolated; at
/// a depth jump it is that of the nearer bearing. Bearings that no beam looks to any more have no return (range 0).
/// @param T_last_first the robot at the first beam, seen from the robot at the last one
Scan deskew(const Scan& scan, const SensorInfo& sensor, const Pose2& T_last_first);

}  // namespace modslam
