// SPDX-License-Identifier: BSD-3-Clause
/// @file How many beams of one scan pass each cell. The beams criss-cross the same cells, which lie close together here and stay in the nearest cache; the map
/// itself, which is larger and was last touched long ago, is gone through once, in order.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace modslam {

class BeamCounts {
 public:
  static constexpr int kTileShift = 6, kTileCells = 1 << kTileShift, kTileMask = kTileCells - 1;  ///< of the map
  static constexpr std::size_t kMostBeams = 65535;                                                ///< of one draw()
  using Cell = std::array<int, 2>;        ///< x, y: cell (i, j) covers [i, i + 1) x [j, j + 1)
  using TileIndex = std::pair<int, int>;  ///< x, y: cells [I, I + 1) x [J, J + 1) times kTileCells
  struct Beam {
    Eigen::Vector2d end;  ///< in cells
    bool hits;            ///< something stands there: the last cell was not passed
    Cell end_cell() const { return {floor_of(end.x()), floor_of(end.y())}; }
  };

  /// Counts every cell that the beams cross. All tiles of the draw before were poured. @param eye where they begin, in cells.
  void draw(const Eigen::Vector2d& eye, const Beam* begin, const Beam* end);

  /// Tiles that beams passed.
  std::vector<TileIndex> tiles() const;
  /// Adds the counts of a tile, times `sign`, to the numbers of its cells, row by row, lowest y first. Its counts are 0 then.
  void pour(const TileIndex& tile, int sign, std::int32_t* numbers);

 private:
  /// A square of cells that holds what most scans see.
  struct Sheet {
    Cell corner;
    std::vector<std::uint16_t> counts;
  };
  static int floor_of(double place) {
    const int whole = static_cast<int>(place);
    return whole - (place < whole);
  }
  Sheet& sheet_at(const Cell& cell);
  void add(const Beam& beam);
  void cross(int axis, const Eigen::Vector2d& way, int borders);
  Cell begin_of(const Sheet& sheet) const;
  Cell end_of(const Sheet& sheet) const;

  Eigen::Vector2d eye_;
  Cell eye_cell_, low_, high_;  ///< low_, high_: the box around all beams
  std::vector<Sheet> sheets_;
  std::size_t used_ = 0, last_ = 0;
};

}  // namespace modslam
