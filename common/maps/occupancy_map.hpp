// SPDX-License-Identifier: BSD-3-Clause
/// @file Occupancy raster that grows with the building. Cells count beams that ended in them and beams that passed; a scan can be
/// taken out again exactly, so after a loop closure only the moved scans are drawn anew.
///
/// Cell (i, j) covers [i, i + 1) x [j, j + 1) times the resolution in the map frame; tile (I, J) holds the cells
/// [I, I + 1) x [J, J + 1) times kTileCells, row by row, lowest y first.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "common/scan/scan.hpp"

namespace modslam {

class OccupancyMap {
 public:
  static constexpr int kTileCells = 64;
  using TileIndex = std::pair<int, int>;  ///< x, y

  OccupancyMap(double resolution_m, double range_limit_m) : resolution_m_(resolution_m), range_limit_m_(range_limit_m) {}

  void insert(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) { draw(scan, sensor, T_map_base, 1); }
  /// Undoes insert() with the same arguments.
  void remove(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) { draw(scan, sensor, T_map_base, -1); }
  void clear();

  /// Tiles changed since the last call.
  std::set<TileIndex> take_changed();
  std::vector<TileIndex> tiles() const;
  /// kTileCells^2 bytes: 0 unknown, else 1 + 254 * probability of being occupied.
  std::vector<std::uint8_t> render(const TileIndex& index) const;
  /// The same in three classes, into kTileCells^2 bytes: 0 unknown, 1 rather free, 255 rather occupied.
  void classes(const TileIndex& index, std::uint8_t* out) const;
  double resolution_m() const { return resolution_m_; }

 private:
  struct Cell {
    std::int32_t ended = 0, passed = 0;
  };
  using Tile = std::array<Cell, kTileCells * kTileCells>;
  void draw(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base, int sign);
  void aim(const Scan& scan);
  void draw_beam(const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool ends_there, int sign);
  Cell& cell(int i, int j);
  void forget_near() { near_.fill({}); }

  double resolution_m_, range_limit_m_;
  std::map<TileIndex, Tile> tiles_;
  std::set<TileIndex> changed_;
  std::vector<Eigen::Vector2d> directions_;  ///< of the beams, laser frame
  double aimed_rad0_ = 0, aimed_radstep_ = 0;
  static constexpr int kNear = 8;  ///< tiles of one scan are found by their last digits
  struct Near {
    TileIndex index{0, 0};
    Tile* tile = nullptr;
  };
  std::array<Near, kNear * kNear> near_;
};

}  // namespace modslam
