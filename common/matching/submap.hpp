// SPDX-License-Identifier: BSD-3-Clause
/// @file A local map of oriented points from several scans, searchable two ways: correlatively and by neighbour.
#pragma once
#include <deque>
#include <optional>
#include <vector>

#include "common/matching/cell_index.hpp"
#include "common/matching/oriented_points.hpp"
#include "common/matching/score_grid.hpp"

namespace modslam {

/// The scan of one keyframe and where it was taken.
struct Keyframe {
  Pose2 T_map_base;
  std::vector<OrientedPoint> points_base;
  Eigen::Vector2d eye_base;  ///< the laser, robot frame
};

/// A small piece of surface, averaged over the map points around one place.
struct Surface {
  Eigen::Vector2d p, n;
  double var_m2 = 0, var_normal_rad2 = 0;
  int count = 0;
};

/// Where refine() finds the partners of its points.
class SurfaceSource {
 public:
  virtual ~SurfaceSource() = default;
  /// The surface nearest to `p` within `gate_m` whose normal agrees with `n` (cosine >= min_cosine).
  /// @return false when there is none.
  virtual bool nearest_surface(const Eigen::Vector2d& p, const Eigen::Vector2d& n, double gate_m, double min_cosine,
                               Surface& out) const = 0;
};

class Submap : public SurfaceSource {
 public:
  /// Replaces the content. "map" is whatever frame the keyframes' poses are given in.
  /// @param blur_m, widest_m of the correlative grid: how far a wall reaches, half width of the widest window that will be searched.
  void build(const std::vector<const Keyframe*>& keyframes, double blur_m, double widest_m);

  /// Points around the nearest one are averaged (radius kAverage_m).
  bool nearest_surface(const Eigen::Vector2d& p, const Eigen::Vector2d& n, double gate_m, double min_cosine,
                       Surface& out) const override;

  /// Share of the segment eye -> p (map frame) that crosses known surfaces more than margin_m before p: 0 or 1.
  bool is_blocked(const Eigen::Vector2d& eye, const Eigen::Vector2d& p, double margin_m) const;

  /// Made when first asked for: most scans need no search.
  const ScoreGrid& score_grid() const;
  std::size_t size() const { return index_.points().size(); }

 private:
  const Surface& surface_at(std::size_t point) const;

  static constexpr double kCell_m = 0.12;
  mutable std::optional<ScoreGrid> score_grid_;
  double blur_m_ = 0, widest_m_ = 0;
  std::vector<Eigen::Vector2d> walls_;  ///< all points, with a normal or without
  CellIndex<OrientedPoint> index_{kCell_m};  ///< points with a normal, map frame
  mutable std::vector<Surface> surfaces_;  ///< around each point of the index; made when first asked for (count 0: not yet)
};

}  // namespace modslam
