// SPDX-License-Identifier: BSD-3-Clause
/// @file How well it is known where a wall ends: what the map shows beyond its ends.
#pragma once
#include <array>
#include <vector>

#include "common/semantics/known_space.hpp"
#include "common/semantics/wall_set.hpp"

namespace modslam {

/// So far is looked for the end of a wall; of one that is not seen to end nearer, no more is said than this.
constexpr double kEndUnseen_m = 1.0;

/// What lies in direction `u` beyond a wall's end p; `normal` points to the side that the wall was seen from. The wall ends somewhere from the
/// beginning of its last occupied cell to the first free one, or in the first cell of the face that it meets: along_m is the rms distance of p from there.
/// across_m is left 0.
WallEnd look_beyond(const KnownSpace& space, const Eigen::Vector2d& p, const Eigen::Vector2d& u, const Eigen::Vector2d& normal);

/// Keeps what is known of the walls' ends in step with the map.
class WallEnds {
 public:
  /// @param come  new walls of the set, @param changed  cells of the space. @return walls whose ends were looked at, some more than once.
  Numbers update(const WallSet& known, const Numbers& come, const KnownSpace& space, const Boxes& changed);
  /// Fills in along_m and seen of a wall of the set, and holds across_m above what cells can tell.
  void fill_in(std::size_t number, Wall& wall, const KnownSpace& space) const;

 private:
  std::vector<std::array<WallEnd, 2>> ends_;  ///< by number of the wall
};

}  // namespace modslam
