// SPDX-License-Identifier: BSD-3-Clause
/// @file Correlative matching: where on a small grid of poses does a scan fit a map best?
///
/// The map is a grid of 0..255 ("how near is a wall"). Coarse levels hold, for a block of cells and the
/// blocks after it, the largest value, so that one sum over the points bounds every pose of a whole block
/// of translations from above: best-first search with these bounds finds the exact maximum.
/// Source: Olson, ICRA 2009 (multi-level table); Hess et al., ICRA 2016 (branch and bound).
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// Half sizes of the searched region around the guess, and how much poses away from the guess lose.
struct SearchWindow {
  double half_m = 0.3;
  double half_rad = 0.1;
  double prior_sigma_m = 0.0;    ///< 0: no preference for the guess
  double prior_sigma_rad = 0.0;
  double prior_weight = 0.0;     ///< score lost at one sigma
};

struct SearchResult {
  Pose2 T_map_base;
  double score = 0;        ///< 0..1, mean over the points, without the preference
  double second_score = 0; ///< of the best pose well away from the winner, or a bound on it (only when asked for)
  bool at_border = false;  ///< the maximum lies on the edge of the window: it may be outside
};

class ScoreGrid {
 public:
  explicit ScoreGrid(double resolution_m = 0.05) : resolution_m_(resolution_m) {}

  /// Fills the grid anew from wall points [m] in the map frame.
  /// @param widest_m half width of the widest window that will be searched fast: wider ones make the coarse levels.
  void build(const std::vector<Eigen::Vector2d>& walls, double blur_m, double widest_m);

  /// @param points_base 2-D points of the scan, robot frame [m].
  /// @param rival_share also look for the best pose well away from the winner; 0: do not. Rivals below this share of the winner are not
  /// told apart: second_score is then what none of them exceeds (with the preference for the guess taken off).
  SearchResult search(const std::vector<Eigen::Vector2d>& points_base, const Pose2& guess, const SearchWindow& window,
                      double rival_share = 0) const;

  /// Mean value under the points at one pose, 0..1.
  double score(const std::vector<Eigen::Vector2d>& points_base, const Pose2& T_map_base) const;
  bool empty() const { return levels_.empty() || levels_[0].width == 0; }

 private:
  class Search;
  struct Level {
    int shift = 0;  ///< a cell stands for 2^shift fine cells along a side
    int width = 0, height = 0;
    std::vector<std::uint8_t> values;
    int at(int x, int y) const {
      return static_cast<unsigned>(x) < static_cast<unsigned>(width) &&
                     static_cast<unsigned>(y) < static_cast<unsigned>(height)
                 ? values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]
                 : 0;
    }
  };
  static Level halve(const Level& fine);
  static Level with_neighbours(const Level& blocks);

  double resolution_m_;
  Eigen::Vector2d origin_{0, 0};
  std::vector<Level> levels_;  ///< by shift; the first levels_ready_ are filled
  std::size_t levels_ready_ = 0;
};

}  // namespace modslam
