// SPDX-License-Identifier: BSD-3-Clause
#include <zlib.h>

#include <cstdlib>
#include <cstring>

#include "common/bus/bus.hpp"
#include "viewer/frames.hpp"

namespace modslam {
namespace {

constexpr std::int32_t kMaxCells = 1024, kMaxTile = 1'000'000;

template <class T>
void append(std::string& bytes, T value) {
  static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the page reads little endian");
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof raw);
}

}  // namespace

std::vector<std::uint8_t> unpack_tile(const map_tile_t& tile) {
  if (tile.encoding != map_tile_t::ZLIB)
    throw BadMessage("tile encoding " + std::to_string(tile.encoding));
  if (tile.ncells < 1 || tile.ncells > kMaxCells)
    throw BadMessage("tile of " + std::to_string(tile.ncells) + " cells");
  if (!(tile.resolution_m >= 1e-3 && tile.resolution_m <= 10.0))
    throw BadMessage("tile resolution " + std::to_string(tile.resolution_m) + " m");
  if (std::abs(static_cast<std::int64_t>(tile.tile_x)) > kMaxTile ||
      std::abs(static_cast<std::int64_t>(tile.tile_y)) > kMaxTile)
    throw BadMessage("tile at " + std::to_string(tile.tile_x) + ", " + std::to_string(tile.tile_y));
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(tile.ncells) *
                                  static_cast<std::size_t>(tile.ncells));
  uLongf size = cells.size();
  uLong used = tile.data.size();
  if (uncompress2(cells.data(), &size, tile.data.data(), &used) != Z_OK || size != cells.size() ||
      used != tile.data.size())
    throw BadMessage("tile data do not unpack to " + std::to_string(cells.size()) + " bytes");
  return cells;
}

FramePtr tile_frame(const map_tile_t& tile) {
  unpack_tile(tile);
  auto frame = std::make_shared<Frame>();
  frame->binary = true;
  append<std::int32_t>(frame->bytes, tile.tile_x);
  append<std::int32_t>(frame->bytes, tile.tile_y);
  append<std::int32_t>(frame->bytes, tile.ncells);
  append<std::int32_t>(frame->bytes, static_cast<std::int32_t>(tile.version));
  append<double>(frame->bytes, tile.resolution_m);
  frame->bytes.append(tile.data.begin(), tile.data.end());
  return frame;
}

}  // namespace modslam
