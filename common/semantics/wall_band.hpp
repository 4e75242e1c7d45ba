// SPDX-License-Identifier: BSD-3-Clause
/// @file A straight line that walls lie on: lines of several blocks, seen from one side, with the least-squares line of all their points.
#pragma once
#include <functional>
#include <vector>

#include "common/semantics/types.hpp"
#include "common/semantics/wall_blocks.hpp"

namespace modslam {

struct WallMapOptions {
  double join_rad = 0.09;      ///< largest angle between a line and the band it joins
  double join_m = 0.09;        ///< largest distance of its middle from the band
  double band_gap_m = 1.8;     ///< longest gap along one band
  double bridge_m = 0.25;      ///< gaps this short inside a wall are closed
  double min_length_m = 0.5;
  int min_sightings = 2;       ///< scans that must have seen a stretch
};

/// Walls of one band, in order along it. Gaps between neighbours are where doors are looked for.
struct WallBand {
  std::vector<Wall> walls;
};

class Band {
 public:
  Band(const WallBlocks::Index& block, const WallBlocks::LineKey& key, const LineSums& sums);

  /// Whether the other lies on this one's line, no farther than a gap away.
  bool takes(const Band& other, const WallMapOptions& options) const;
  void absorb(const Band& other);
  WallBand walls(const WallMapOptions& options, const std::function<bool(const Eigen::Vector2d&)>& is_solid) const;
  /// To the bit: with the same surroundings it has the same walls.
  bool operator==(const Band& o) const {
    return n_ == o.n_ && mean_ == o.mean_ && towards_ == o.towards_ && scatter_ == o.scatter_ && stretches_ == o.stretches_;
  }
  double points() const { return n_; }
  double length_m() const { return high_ - low_; }
  Eigen::Vector2d low_end() const { return mean_ + low_ * direction_; }
  Eigen::Vector2d high_end() const { return mean_ + high_ * direction_; }

 private:
  struct Stretch {
    Eigen::Vector2d first, step;  ///< places of its bins
    std::vector<std::int32_t> sightings;
    bool operator==(const Stretch& o) const { return first == o.first && step == o.step && sightings == o.sightings; }
  };
  double along(const Eigen::Vector2d& p) const { return direction_.dot(p - mean_); }
  double across(const Eigen::Vector2d& p) const { return direction_.x() * (p.y() - mean_.y()) - direction_.y() * (p.x() - mean_.x()); }
  double sigma_across_m(double along_m) const;
  void refit();

  double n_, low_ = 0, high_ = 0, sigma_m_ = 0, along_m2_ = 0;
  Eigen::Vector2d mean_, towards_, direction_;
  Eigen::Matrix2d scatter_;
  std::vector<Stretch> stretches_;
  std::vector<Eigen::Vector2d> ends_;   ///< of stretches, those that may be outermost
};

}  // namespace modslam
