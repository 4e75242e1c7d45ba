// SPDX-License-Identifier: BSD-3-Clause
#include "common/maps/mosaic.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace modslam {
namespace {

constexpr std::int64_t kMaxCells = 200'000'000;  // 700 m x 700 m at 5 cm

/// Cells of the global lattice, upper ends exclusive.
struct CellBox {
  std::int64_t x0 = std::numeric_limits<std::int64_t>::max(), y0 = x0, x1 = -x0, y1 = -x0;

  void add(std::int64_t x, std::int64_t y) {
    x0 = std::min(x0, x), x1 = std::max(x1, x + 1);
    y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
  }
};

template <class Visit>  // visit(global column, global row, value) for each known cell
void each_known_cell(const MapTile& tile, Visit&& visit) {
  const std::int64_t n = tile.ncells;
  for (std::int64_t row = 0; row < n; ++row)
    for (std::int64_t column = 0; column < n; ++column)
      if (const std::uint8_t value = tile.cells[static_cast<std::size_t>(row * n + column)])
        visit(tile.x * n + column, tile.y * n + row, value);
}

}  // namespace

std::vector<std::uint8_t> unpack_cells(const void* packed, std::size_t size, int ncells) {
  if (ncells < 1 || ncells > 4096)
    throw std::runtime_error("a tile of " + std::to_string(ncells) + " cells a side");
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(ncells) * ncells);
  uLongf length = cells.size();
  const int status = uncompress(cells.data(), &length, static_cast<const Bytef*>(packed), size);
  if (status != Z_OK || length != cells.size())
    throw std::runtime_error("a tile whose bytes cannot be unpacked");
  return cells;
}

std::vector<std::uint8_t> pack_cells(const std::vector<std::uint8_t>& cells) {
  // A tile is small: the window and tables of the defaults take longer to clear than the tile to pack.
  constexpr int kWindowBits = 12, kMemLevel = 5;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kWindowBits, kMemLevel, Z_RLE) != Z_OK)
    throw std::runtime_error("zlib cannot start");
  std::vector<std::uint8_t> packed(deflateBound(&stream, cells.size()));
  stream.next_in = const_cast<Bytef*>(cells.data());
  stream.avail_in = static_cast<uInt>(cells.size());
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  const int status = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib cannot pack a tile");
  return packed;
}

MapImage join_tiles(const std::vector<MapTile>& tiles, int margin_cells) {
  CellBox box;
  for (const MapTile& tile : tiles) {
    if (tile.ncells != tiles[0].ncells || tile.resolution_m != tiles[0].resolution_m)
      throw std::runtime_error("map tiles of two sizes or resolutions");
    each_known_cell(tile, [&](std::int64_t x, std::int64_t y, std::uint8_t) { box.add(x, y); });
  }
  MapImage image;
  if (box.x1 < box.x0) return image;
  const std::int64_t width = box.x1 - box.x0 + 2 * margin_cells,
                     height = box.y1 - box.y0 + 2 * margin_cells;
  if (width > kMaxCells / height)
    throw std::runtime_error("a map of " + std::to_string(width) + " x " + std::to_string(height) +
                             " cells");
  const std::int64_t x0 = box.x0 - margin_cells, y0 = box.y0 - margin_cells;
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.resolution_m = tiles[0].resolution_m;
  image.origin_m =
      Eigen::Vector2d(static_cast<double>(x0), static_cast<double>(y0)) * image.resolution_m;
  image.cells.assign(static_cast<std::size_t>(width * height), 0);
  for (const MapTile& tile : tiles)
    each_known_cell(tile, [&](std::int64_t x, std::int64_t y, std::uint8_t value) {
      image.cells[static_cast<std::size_t>((y - y0) * width + (x - x0))] = value;
    });
  return image;
}

}  // namespace modslam
