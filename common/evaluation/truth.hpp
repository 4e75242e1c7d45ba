// SPDX-License-Identifier: BSD-3-Clause
/// @file Scores a path against the true path of a simulated run.
#pragma once
#include <optional>
#include <vector>

#include "common/evaluation/path.hpp"
#include "common/evaluation/statistics.hpp"

namespace modslam {

/// A true pose and the estimate for the same moment.
struct PosePair {
  double stamp_s = 0;
  Pose2 T_world_base;  ///< truth
  Pose2 T_map_base;    ///< estimate
};

/// Interpolates the truth at the estimate's stamps. Estimates outside the truth, or where it has a
/// gap of more than a second, are left out and counted in *unpaired. The truth may come in any
/// order.
std::vector<PosePair> pair_with_truth(const Path& estimate, Path truth,
                                      std::size_t* unpaired = nullptr);

/// T_world_map that lays the first estimate upon its truth. @pre pairs not empty.
Pose2 align_first(const std::vector<PosePair>& pairs);

/// T_world_map that minimises the squared distances between true and estimated places, closed form.
/// Source: Umeyama, PAMI 1991, without scale. The first pose decides the turn when the robot never
/// moved.
Pose2 align_least_squares(const std::vector<PosePair>& pairs);

struct AbsoluteError {
  Pose2 T_world_map;
  Statistics position_m, heading_deg;
  std::vector<double> stamps_s, positions_m, headings_deg;  ///< over time; heading signed
};
AbsoluteError absolute_error(const std::vector<PosePair>& pairs, const Pose2& T_world_map);

/// Error of the motion from each pose to the first one that lies `travelled_m` of true path later.
struct RelativeError {
  double travelled_m = 0;
  Statistics translation_m, rotation_deg;
};
RelativeError relative_error(const std::vector<PosePair>& pairs, double travelled_m);

/// Everything that is said of a path whose truth is known.
struct TruthScores {
  AbsoluteError first_pose, least_squares;  ///< by alignment
  std::vector<RelativeError> relative;      ///< over 1, 5, 10 m
  std::size_t unpaired = 0;                 ///< estimates without truth
};
/// @throws std::runtime_error when no pose has a truth.
TruthScores score_against_truth(const Path& T_map_base, const Path& truth);

}  // namespace modslam
