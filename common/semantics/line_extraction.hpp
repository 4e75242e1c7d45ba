// SPDX-License-Identifier: BSD-3-Clause
/// @file Straight pieces of one scan: a probabilistic Hough transform on metric points.
///
/// Seeds are drawn from the points that no segment has claimed, in a fixed pseudo-random order. A
/// seed and its beam neighbours vote for (theta, r) buckets; the points of the best bucket are
/// ordered along the line and split at gaps; the piece that holds the seed is refined by total
/// least squares. What ends on a segment is wall-like, all else is not. Source: Kiryati et al. 1991
/// (probabilistic Hough); thesis section 3.4.1. We differ: metric points, range-dependent gaps.
#pragma once
#include <vector>

#include "common/scan/scan.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct ClassifiedScan {
  std::vector<Eigen::Vector2d> points;  ///< returns, base frame, beam order
  std::vector<int> segment_of;          ///< index into segments, -1: on none
  std::vector<Segment> segments;        ///< base frame
};

struct LineExtractionParameters {
  double min_length_m = 0.5;
  double across_m = 0.05;  ///< points farther from the line are not on it
  double max_gap_m = 0.3;  ///< larger gaps split, unless the beams are that far apart
  int min_points = 6;
};

/// @param points  returns of one scan in beam order, any frame. @param radstep  angle between beams
/// [rad]. Cost: about O(N * segments). The same points give the same segments. A wall across the
/// first and the last beam of a full circle comes as two segments.
ClassifiedScan extract_lines(const std::vector<ScanPoint>& points, double radstep,
                             const LineExtractionParameters& parameters);

/// Total least squares line through points: centre, unit direction, standard deviation across.
struct FittedLine {
  Eigen::Vector2d centre, direction;
  double sigma_m;
};
/// @param weights  one for each point, > 0. @param points  at least two distinct ones.
FittedLine fit_line(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& weights);

}  // namespace modslam
