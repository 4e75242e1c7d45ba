// SPDX-License-Identifier: BSD-3-Clause
/// @file How far a path is from the true one, after one rigid motion has laid it over it.
#pragma once
#include <optional>
#include <vector>

#include "common/geometry/path_pose.hpp"

namespace modslam {

/// A pose of the path and the true pose at its time.
struct TruthPair {
  std::int64_t utime = 0;
  Pose2 T_map_base;    ///< estimated
  Pose2 T_world_base;  ///< true
};

/// Truth at each stamp of the path, interpolated between the true poses around it. Stamps that no
/// true pose brackets within max_gap_us are left out. Both lists may step back in time; the path's
/// order is kept.
std::vector<TruthPair> pair_path_with_truth(const std::vector<PathPose>& path,
                                            std::vector<PathPose> truth, std::int64_t max_gap_us);

/// T_world_map that lays the first pose of the path on its true pose. Nothing when there are no
/// pairs.
std::optional<Pose2> lay_by_first_pose(const std::vector<TruthPair>& pairs);
/// T_world_map that makes the sum of squared distances least (Umeyama 1991 in the plane, without
/// scale). A path that never moved leaves the heading open: then as lay_by_first_pose.
std::optional<Pose2> lay_by_least_squares(const std::vector<TruthPair>& pairs);

struct PathError {
  std::vector<double> position_m, heading_rad;  ///< one of each a pair, not negative
};
PathError path_error(const std::vector<TruthPair>& pairs, const Pose2& T_world_map);

struct ErrorFigures {
  double mean = 0, rms = 0, max = 0;
};
ErrorFigures figures(const std::vector<double>& errors);

}  // namespace modslam
