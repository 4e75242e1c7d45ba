// SPDX-License-Identifier: BSD-3-Clause
/// @file Small things that a scan meets with a beam or two: door jambs, edges of cupboards, pillars
/// far away.
///
/// They are too small for a normal of their own in one scan, so point-to-line matching passes them
/// by; yet in a bare corridor they are all that speaks of the way along it. Over several keyframes
/// their points pile up in one place, while the points that grazing beams leave on a wall are
/// strewn along it: a pile that is narrow in a direction fixes that direction.
#pragma once
#include <optional>
#include <vector>

#include "common/matching/submap.hpp"

namespace modslam {

/// A pile of points that several keyframes left in one place.
struct Pile {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();  ///< covariance of one point about the mean
  int points = 0, keyframes = 0;
};

class Landmarks {
 public:
  Landmarks();
  /// Replaces the content; "map" is whatever frame the keyframes' poses are given in.
  void build(const std::vector<const Keyframe*>& keyframes);
  /// The pile around the isolated point nearest to `p` (map frame) within `gate_m`; nothing where
  /// too few keyframes left points. Points with a surface count too: that is how a wall is known
  /// for one.
  std::optional<Pile> pile_at(const Eigen::Vector2d& p, double gate_m) const;

 private:
  struct Point {
    Eigen::Vector2d p;
    int keyframe;
    bool isolated;  ///< without a surface of its own
  };
  std::optional<Eigen::Vector2d> nearest_isolated(const Eigen::Vector2d& p, double gate_m) const;
  Pile gather(const Eigen::Vector2d& centre) const;

  CellIndex<Point> index_;
};

/// What the landmarks say of one direction; all zero when they say nothing that holds together.
struct LandmarkFit {
  double shift_m = 0;      ///< to be added along the direction: landmarks and guess together
  double information = 0;  ///< of the landmarks alone [1/m^2]
  int points = 0;          ///< of the scan, that stand on a pile
};

/// Moves a scan along one direction until its isolated points stand on their piles.
/// @param points robot frame
/// @param T_map_base where the scan stands by all else
/// @param along unit vector, map frame
/// @param sigma_m of T_map_base in that direction
LandmarkFit fit_along(const std::vector<OrientedPoint>& points, const Landmarks& landmarks, const Pose2& T_map_base, const Eigen::Vector2d& along,
                      double sigma_m);

}  // namespace modslam
