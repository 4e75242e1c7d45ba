// SPDX-License-Identifier: BSD-3-Clause
/// @file Straight pieces of one scan by a probabilistic Hough transform on metric points (thesis 3.4.1).
#pragma once
#include <vector>

#include "common/semantics/hough_votes.hpp"

namespace modslam {

struct Segment {
  Eigen::Vector2d a, b;  ///< ends, frame of the points; the viewer lies to the left of a -> b
  int points = 0;
  double sigma_m = 0;    ///< rms of the points across it
  double length_m() const { return (b - a).norm(); }
};

struct HoughOptions {
  double cell_m = 0.05;         ///< width of a bucket in the distance to the origin
  double cell_rad = 0.035;      ///< width of a bucket in the angle
  double thickness_m = 0.05;    ///< points this near to a line belong to it
  double gap_m = 0.35;          ///< a wider gap between neighbours ends a segment, unless beams are that far apart
  double min_length_m = 0.5;
  int min_points = 6;
};

struct LineExtraction {
  std::vector<Segment> segments;
  std::vector<bool> on_segment;  ///< for each point
};

/// Takes the fullest bucket, fits a line, cuts it at gaps, removes its points, again until no bucket is full enough. Keeps its tables from scan to scan.
class LineExtractor {
 public:
  explicit LineExtractor(const HoughOptions& options) : options_(options), votes_(options.cell_m, options.cell_rad) {}

  /// @param points one scan in beam order, any frame; @param eye where the laser was, same frame; @param radstep angle between beams.
  LineExtraction operator()(const std::vector<ScanPoint>& points, const Eigen::Vector2d& eye, double radstep);

 private:
  HoughOptions options_;
  HoughVotes votes_;
};

/// The same for one scan alone.
LineExtraction extract_lines(const std::vector<ScanPoint>& points, const Eigen::Vector2d& eye, double radstep, const HoughOptions& options);

}  // namespace modslam
