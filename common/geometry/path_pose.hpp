// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// A pose and the time it belongs to [us].
struct PathPose {
  std::int64_t utime = 0;
  Pose2 pose;
};

}  // namespace modslam
