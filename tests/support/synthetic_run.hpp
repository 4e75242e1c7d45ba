// SPDX-License-Identifier: BSD-3-Clause
/// @file A made-up run: a robot drives a figure-eight through two rooms and a door, twice. Its
/// estimator drifts on the first lap and is put right by loop edges on the second. Everything a
/// real run's log holds is in the log.
#pragma once
#include <string>
#include <vector>

#include "common/geometry/path_pose.hpp"

namespace modslam::test {

struct SyntheticRun {
  std::vector<PathPose> truth;  ///< T_world_base, one a scan
  Pose2 T_world_map;
  Pose2 T_base_laser;
  int nodes = 0, loop_edges = 0;
  double lap_m = 0;
};

/// Writes the log. `scans` of 10 Hz; 1200 are two laps.
/// @param drop_pose_every  leaves out every n-th POSE; 0: none.
SyntheticRun write_synthetic_run(const std::string& log_path, int scans, int drop_pose_every = 0,
                                 std::int64_t start_utime = 1'000'000'000);

}  // namespace modslam::test
