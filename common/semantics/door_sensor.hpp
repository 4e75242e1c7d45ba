// SPDX-License-Identifier: BSD-3-Clause
/// @file The door sensor: openings in one scan (thesis, algorithm 5).
#pragma once
#include <vector>

#include "common/scan/scan.hpp"

namespace modslam {

/// Beams longer than their surroundings leave between two jambs; robot frame.
struct DoorSighting {
  Eigen::Vector2d a, b;
};

struct DoorSensorOptions {
  double depth_m = 0.5;      ///< beams through an opening are longer by this much
  double min_width_m = 0.6, max_width_m = 1.7;
  double range_limit_m = 10;  ///< jambs farther away are not looked at
};

std::vector<DoorSighting> sight_doors(const Scan& scan, const SensorInfo& sensor, const DoorSensorOptions& options);

}  // namespace modslam
