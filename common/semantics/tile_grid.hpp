// SPDX-License-Identifier: BSD-3-Clause
/// @file A sparse grid of small square tiles that come into being when they are first written.
///
/// Cell (ix, iy) covers [ix, ix + 1) x [iy, iy + 1) times the resolution; it is named by its lower
/// left corner.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>

namespace modslam {

template <class Cell>
class TileGrid {
 public:
  static constexpr int kShift = 5, kSide = 1 << kShift;
  using Tile = std::array<Cell, kSide * kSide>;

  explicit TileGrid(double resolution_m) : resolution_m_(resolution_m) {}

  double resolution_m() const { return resolution_m_; }
  int index(double metres) const { return static_cast<int>(std::floor(metres / resolution_m_)); }
  double centre_m(int index) const { return (index + 0.5) * resolution_m_; }

  Cell& at(int ix, int iy) { return tile(ix >> kShift, iy >> kShift)[inner(ix, iy)]; }

  /// @return nullptr where nothing was written.
  const Cell* find(int ix, int iy) const {
    const auto found = tiles_.find(key(ix >> kShift, iy >> kShift));
    return found == tiles_.end() ? nullptr : &(*found->second)[inner(ix, iy)];
  }

  void clear() {
    tiles_.clear();
    last_ = nullptr;
  }

  /// Calls visit(ix, iy, cell) tile by tile, in ascending order of tile and cell.
  template <class Visit>
  void each(Visit&& visit) const {
    std::map<std::pair<int, int>, const Tile*> ordered;
    for (const auto& [k, t] : tiles_)
      ordered[{static_cast<std::int32_t>(k >> 32), static_cast<std::int32_t>(k & 0xffffffff)}] =
          t.get();
    for (const auto& [where, t] : ordered)
      for (int i = 0; i < kSide * kSide; ++i)
        visit(where.first * kSide + i % kSide, where.second * kSide + i / kSide,
              (*t)[static_cast<std::size_t>(i)]);
  }

 private:
  static std::uint64_t key(int tx, int ty) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(tx)) << 32 |
           static_cast<std::uint32_t>(ty);
  }
  static std::size_t inner(int ix, int iy) {
    return static_cast<std::size_t>((iy & (kSide - 1)) << kShift | (ix & (kSide - 1)));
  }
  Tile& tile(int tx, int ty) {
    const std::uint64_t k = key(tx, ty);
    if (last_ && last_key_ == k) return *last_;
    auto& slot = tiles_[k];
    if (!slot) slot = std::make_unique<Tile>();
    last_key_ = k;
    last_ = slot.get();
    return *last_;
  }

  double resolution_m_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Tile>> tiles_;
  std::uint64_t last_key_ = 0;
  Tile* last_ = nullptr;
};

}  // namespace modslam
