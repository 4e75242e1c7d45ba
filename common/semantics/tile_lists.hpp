// SPDX-License-Identifier: BSD-3-Clause
/// @file A list for each tile of a raster, all of them end to end in one array: who goes through all reads memory in order.
#pragma once
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace modslam {

template <class Thing>
class TileLists {
 public:
  explicit TileLists(int tiles = 0) : first_(static_cast<std::size_t>(tiles) + 1, 0) {}

  /// Place of a tile's first thing among all.
  std::size_t first(int tile) const { return first_[static_cast<std::size_t>(tile)]; }
  std::size_t size(int tile) const { return first(tile + 1) - first(tile); }
  Thing* begin(int tile) { return all_.data() + first(tile); }
  const Thing* begin(int tile) const { return all_.data() + first(tile); }
  const Thing* end(int tile) const { return begin(tile) + size(tile); }
  std::vector<Thing>& all() { return all_; }
  const std::vector<Thing>& all() const { return all_; }

  /// Gives some tiles other lists.
  void replace(const std::map<int, std::vector<Thing>>& lists) {
    std::vector<Thing> now;
    now.reserve(all_.size() + 64);
    std::size_t copied = 0, tile = 0, moved = 0;   // moved: how far lists stand behind where they stood; modulo 2^64
    const auto take_over = [&](std::size_t next_tile, std::size_t end) {
      for (; tile < next_tile; ++tile) first_[tile] += moved;
      now.insert(now.end(), all_.begin() + static_cast<std::ptrdiff_t>(copied), all_.begin() + static_cast<std::ptrdiff_t>(end));
    };
    for (const auto& [index, list] : lists) {
      const std::size_t from = first(index), to = first(index + 1);
      take_over(static_cast<std::size_t>(index) + 1, from);
      now.insert(now.end(), list.begin(), list.end());
      moved += list.size() - (to - from);
      copied = to;
    }
    take_over(first_.size(), all_.size());
    all_ = std::move(now);
  }

  /// The raster has more columns and rows now, and the tiles that it had stand elsewhere; their order is the same.
  void grow(int columns_before, int columns, int rows, int shift_column, int shift_row) {
    std::vector<std::size_t> before(static_cast<std::size_t>(columns * rows) + 1, all_.size());
    std::swap(first_, before);
    for (int tile = columns * rows, known = static_cast<int>(before.size()) - 1; tile >= 0; --tile) {
      const int row = tile / columns - shift_row, column = tile % columns - shift_column;
      const int old = row * columns_before + column;
      if (tile < columns * rows && row >= 0 && column >= 0 && column < columns_before && old < static_cast<int>(before.size()) - 1) known = old;
      first_[static_cast<std::size_t>(tile)] = before[static_cast<std::size_t>(known)];
    }
  }

 private:
  std::vector<Thing> all_;
  std::vector<std::size_t> first_;   ///< one more than there are tiles
};

}  // namespace modslam
