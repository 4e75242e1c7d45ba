// SPDX-License-Identifier: BSD-3-Clause
/// @file Evidence for straight walls, in squares of the plan: segments of all scans as sums over (direction, distance), a Hough table of what was seen.
///
/// Sums are whole numbers, so a scan that goes leaves them as if it had never come, and their number does not grow with the scans.
#pragma once
#include <array>
#include <map>
#include <set>

#include "common/semantics/hough.hpp"

namespace modslam {

/// Segments of nearly one line within a block.
struct LineSums {
  static constexpr double kBin_m = 0.05;
  static constexpr int kBins = 192;

  std::int64_t n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;  ///< points and their moments about the block's centre, fixed point
  std::int64_t ux = 0, uy = 0;                               ///< sum of directions
  std::array<std::int32_t, kBins> sightings{};               ///< segments along the bin's direction; the centre of the block is the middle
};

class WallBlocks {
 public:
  static constexpr double kBlock_m = 6.4;
  using Index = std::pair<int, int>;       ///< x, y
  using LineKey = std::pair<int, int>;     ///< direction, distance
  using Lines = std::map<LineKey, LineSums>;

  /// A segment of one scan, map frame; sign -1 takes it back.
  void add(const Segment& segment, int sign);
  /// Blocks whose lines changed since the last call.
  std::set<Index> take_changed();
  const std::map<Index, Lines>& blocks() const { return blocks_; }

  static Eigen::Vector2d centre(const Index& index) { return kBlock_m * Eigen::Vector2d(index.first + 0.5, index.second + 0.5); }
  static Eigen::Vector2d direction(const LineKey& key);

 private:
  void add_piece(const Segment& piece, double points, int sign);

  std::map<Index, Lines> blocks_;
  std::set<Index> changed_;
};

/// Counts of LineSums are in these units.
constexpr double kPointUnit = 1.0 / 16, kLengthUnit = 1.0 / 1024;

}  // namespace modslam
