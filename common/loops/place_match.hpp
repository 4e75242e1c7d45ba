// SPDX-License-Identifier: BSD-3-Clause
/// @file One scan against the scans of places that were seen before, with a verdict.
#pragma once
#include <vector>

#include "common/geometry/pose2.hpp"
#include "common/matching/submap.hpp"
#include "common/matching/verdict.hpp"

namespace modslam {

struct PlaceLimits {
  double min_overlap = 0.55;        ///< share of the points that must find a partner
  double max_chi2 = 12.0;           ///< reduced, of the residuals
  double max_ambiguity = 0.92;      ///< score of the second-best place over the best
  double information_scale = 0.10;  ///< share of a match's information that counts
};

struct PlaceMatch {
  Pose2 T_map_base;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< in the frame of the robot, order x y heading; 0 where nothing was seen
  Verdict verdict = Verdict::kInvalid;
  MatchFigures figures;
};

/// @param now its pose is where the graph has it.
/// @param known what it is matched to, rendered into one local map.
/// @param cov how well the graph knows `now` relative to `known`, in the frame of `now`: how far to look, and what to expect.
PlaceMatch match_place(const Keyframe& now, const std::vector<const Keyframe*>& known, const Eigen::Matrix3d& cov, const PlaceLimits& limits);

/// Largest standard deviation of the position, over all directions [m].
double position_sigma(const Eigen::Matrix3d& cov);

}  // namespace modslam
