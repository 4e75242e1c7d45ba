// SPDX-License-Identifier: BSD-3-Clause
/// @file A path in TUM text: one pose a line, `stamp x y z qx qy qz qw`, in the order of the scans.
#pragma once
#include <string_view>
#include <vector>

#include "common/geometry/pose2.hpp"

namespace modslam {

struct StampedPose {
  double stamp_s = 0;
  Pose2 pose;
};
using Path = std::vector<StampedPose>;

/// Blank lines and # comments are skipped. @throws std::runtime_error naming the line when one is
/// no pose, or when there is none at all.
Path parse_tum(std::string_view text);

}  // namespace modslam
