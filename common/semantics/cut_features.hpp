// SPDX-License-Identifier: BSD-3-Clause
/// @file What is measured of a cut through the floor.
#pragma once
#include "common/semantics/openings.hpp"

namespace modslam {

class CutFeatures {
 public:

  CutFeatures(const Floor& floor, const KnownSpace& space, const WallSet& walls);

  /// @param narrowest  length of the narrowest cut near by. @param reads  set to where the floor was looked at.
  Opening measure(const FloorCut& cut, double narrowest, CutReads& reads) const;
  /// The features that tell of walls at the ends, filled in. @return whether that changed them.
  bool measure_walls(Opening& opening) const;

 private:
  struct Side {
    double depth_m = 0, clearance = 0, flare = 0;
  };
  bool is_open(const Eigen::Vector2d& p) const {
    const cv::Point c(cvRound(p.x()), cvRound(p.y()));
    return c.x >= 0 && c.y >= 0 && c.x < floor_.open.cols && c.y < floor_.open.rows && floor_.open(c);
  }
  double solid_beyond_m(const Eigen::Vector2d& p, const Eigen::Vector2d& out, CutReads& reads) const;
  double hit_share(const Eigen::Vector2d& p, const Eigen::Vector2d& out, CutReads& reads) const;
  Side look(const FloorCut& cut, const Eigen::Vector2d& n, CutReads& reads) const;
  double wall_at_m(const Eigen::Vector2d& p) const;

  const Floor& floor_;
  const KnownSpace& space_;
  const WallSet& walls_;
  double cell_m_;
};

/// Whether the way from a to b leads over floor but for its very ends.
bool is_clear(const Floor& floor, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

}  // namespace modslam
