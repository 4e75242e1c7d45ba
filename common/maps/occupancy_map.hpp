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

#include "common/maps/beam_counts.hpp"
#include "common/scan/scan.hpp"

namespace modslam {

class OccupancyMap {
 public:
  static constexpr int kTileCells = BeamCounts::kTileCells;
  using TileIndex = BeamCounts::TileIndex;  ///< x, y

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
  /// Row by row, lowest y first. In two arrays: few cells have beams that end in them.
  struct Tile {
    std::array<std::int32_t, kTileCells * kTileCells> passed{}, ended{};
  };
  void draw(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base, int sign);
  void aim(const Scan& scan);
  void draw_hits(int sign);
  Tile& tile_to_change(const TileIndex& index);

  double resolution_m_, range_limit_m_;
  std::map<TileIndex, Tile> tiles_;
  std::set<TileIndex> changed_;
  std::vector<Eigen::Vector2d> directions_;  ///< of the beams, laser frame
  double aimed_rad0_ = 0, aimed_radstep_ = 0;
  std::vector<BeamCounts::Beam> beams_;      ///< of the scan at hand
  BeamCounts counts_;
};

}  // namespace modslam
