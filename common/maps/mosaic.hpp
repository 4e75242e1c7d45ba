// SPDX-License-Identifier: BSD-3-Clause
/// @file One picture from the tiles of a map.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace modslam {

/// A square piece of the map. Cell (column, row) has its lower left corner at
/// ((x * ncells + column) * resolution_m, (y * ncells + row) * resolution_m) in the map frame.
struct MapTile {
  int x = 0, y = 0;
  int ncells = 0;
  double resolution_m = 0;
  std::vector<std::uint8_t>
      cells;  ///< row 0 lowest y; 0 unknown, else 1 + 254 * probability of being occupied
};

/// The same kind of cells on one rectangle that just holds what is known.
struct MapImage {
  int width = 0, height = 0;
  double resolution_m = 0;
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< lower left corner of cell (0, 0)
  std::vector<std::uint8_t> cells;

  bool empty() const { return cells.empty(); }
  std::uint8_t at(int column, int row) const {
    return cells[static_cast<std::size_t>(row) * width + column];
  }
};

/// @throws std::runtime_error when the bytes are not ncells^2 zlib-packed cells.
std::vector<std::uint8_t> unpack_cells(const void* packed, std::size_t size, int ncells);
std::vector<std::uint8_t> pack_cells(const std::vector<std::uint8_t>& cells);

/// Joins tiles of one kind and crops to the known cells and `margin_cells` around them. No known
/// cell: an empty image.
/// @throws std::runtime_error when tiles disagree on size or resolution, or lie so far apart that
/// no picture can hold them.
MapImage join_tiles(const std::vector<MapTile>& tiles, int margin_cells);

}  // namespace modslam
