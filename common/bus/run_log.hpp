// SPDX-License-Identifier: BSD-3-Clause
/// @file What scorers need of a run's LCM log: the true path, the estimated one, and sweeps at
/// their true place.
#pragma once
#include <string>
#include <vector>

#include "common/evaluation/path.hpp"
#include "common/evaluation/visibility.hpp"

namespace modslam {

struct RunLog {
  Path truth;                     ///< GROUND_TRUTH: T_world_base
  Path estimate;                  ///< POSE: T_map_base as it was said during the run
  std::vector<PlacedScan> scans;  ///< sweeps that have a true pose (interpolated) and a known mount
  std::size_t unplaced_scans = 0;  ///< the others
  std::int64_t bad_messages = 0;   ///< undecodable or refused
  std::string damage;              ///< of the file, or ""
};

/// @throws std::runtime_error naming the file when it is no LCM log. Missing channels leave their
/// part empty.
RunLog read_run_log(const std::string& path);

}  // namespace modslam
