// SPDX-License-Identifier: BSD-3-Clause
/// @file TUM trajectory text: one line a pose, "stamp_s x y z qx qy qz qw" in metres and a unit
/// quaternion.
#pragma once
#include <string>
#include <vector>

#include "common/geometry/path_pose.hpp"

namespace modslam {

/// Stamps keep their microseconds (6 decimals), numbers have 9 decimals. Lines stand in the order
/// given.
std::string tum_text(const std::vector<PathPose>& path);

}  // namespace modslam
