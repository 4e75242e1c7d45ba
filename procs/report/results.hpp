// SPDX-License-Identifier: BSD-3-Clause
/// @file What follows from a run's record: the final path, the map as one picture, the errors
/// against the truth.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "common/evaluation/loop_check.hpp"
#include "common/evaluation/truth.hpp"
#include "common/geometry/path_pose.hpp"
#include "common/maps/mosaic.hpp"
#include "procs/report/run_record.hpp"

namespace modslam::report {

/// A path laid over the true one in two ways: by its first pose, and by least squares.
struct TruthComparison {
  std::vector<PosePair> pairs;
  AbsoluteError first, best;
};

struct Results {
  std::vector<PathPose> path;           ///< T_map_base, one a POSE
  std::vector<PathPose> path_laser;     ///< T_map_laser, one a LASER in file order
  std::int64_t scans_without_pose = 0;  ///< these were interpolated
  std::int64_t poses_without_scan = 0;
  std::int64_t stamps_stepped_back = 0;
  std::int64_t start_utime = 0;  ///< earliest scan; times in the report count from here
  double duration_s = 0;
  double path_length_m = 0;
  std::map<NodeId, Pose2> nodes;
  LoopCheck loops_in_map;                    ///< against where the nodes are in the end
  std::optional<LoopCheck> loops_in_truth;  ///< against where they truly were
  int edges_without_node = 0;  ///< left out of graph.g2o
  std::string graph_g2o;
  MapImage map;
  double known_area_m2 = 0;
  std::string map_trouble;  ///< why there is no map, when tiles came but cannot be joined
  std::optional<TruthComparison> error, odometry_error;
  std::vector<std::pair<std::string, TruthComparison>> peer_errors;  ///< of other systems on the same log, by name
};

Results work_out(const RunRecord& run);

}  // namespace modslam::report
