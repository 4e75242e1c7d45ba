// SPDX-License-Identifier: BSD-3-Clause
/// @file Weighted scan matching, scan to scan, as the thesis used it: every pair of points weighs by the noise of both ranges, by what
/// the laser is biased by, and by how far the two points may lie apart on their surface.
///
/// Kept to compare with, not to drive with: the spread along the surface is taken for independent noise, so many points of one bare
/// wall add up to a confidence along it that nothing measured (docs/decisions.md; the local map's matcher claims nothing there).
/// Source: Pfister, Kriechbaum, Roumeliotis, Burdick, ICRA 2002.
#pragma once
#include "common/matching/submap.hpp"

namespace modslam {

struct WeightedMatchOptions {
  RangeNoise noise;
  double sigma_bias_m = 0.005;
  double radstep = 0.0175;        ///< between two beams
  double gate_start_m = 0.5, gate_end_m = 0.10;
  int max_iterations = 50;
};

struct WeightedMatchResult {
  Pose2 T_reference_base;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< order x y heading, frame of the reference, as the paper has it
  double overlap = 0;  ///< share of the points that found a partner
  double chi2 = 0;     ///< reduced
  int pairs = 0, iterations = 0;
  bool converged = false;
};

/// @param reference the earlier scan; its pose does not matter. @param points, eye_base the later scan and its laser, robot frame.
/// @param cov_guess of `guess`, order x y heading, frame of the reference: what a pair may disagree by.
WeightedMatchResult match_weighted(const Keyframe& reference, const std::vector<OrientedPoint>& points, const Eigen::Vector2d& eye_base,
                                   const Pose2& guess, const Eigen::Matrix3d& cov_guess, const WeightedMatchOptions& options);

}  // namespace modslam
