// SPDX-License-Identifier: BSD-3-Clause
/// @file Evidence for wall or object, cell by cell, as log-odds (thesis 3.4.1). Counts, so that a scan can be taken out exactly.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

namespace modslam {

class EvidenceGrid {
 public:
  explicit EvidenceGrid(double resolution_m = 0.05) : resolution_m_(resolution_m) {}

  /// One scan point at p [m], on a straight piece or not; sign -1 takes it back.
  void add(const Eigen::Vector2d& p, bool on_line, int sign) {
    const int i = index(p.x()), j = index(p.y());
    if (const std::int64_t key = key_of(i, j); last_ == tiles_.size() || key != last_key_) {  // a scan's points stay in a tile for a while
      last_key_ = key;
      last_ = numbers_.emplace(key, tiles_.size()).first->second;
      if (last_ == tiles_.size()) tiles_.push_back({});
    }
    tiles_[last_][cell_of(i, j)] += on_line ? sign : -sign;
    if (const Index tile(i >> kShift, j >> kShift); changed_.empty() || changed_.back() != tile) changed_.push_back(tile);
  }
  /// Cells (column, row; counted from the map's origin) whose log-odds changed since the last call, as squares: corner and width.
  std::vector<std::array<int, 3>> take_changed() {
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    std::vector<std::array<int, 3>> out;
    for (const Index& tile : changed_) out.push_back({tile.first * kSide - 1, tile.second * kSide - 1, kSide + 2});
    changed_.clear();
    return out;
  }
  /// Log-odds of wall against object at p, over the cell and its neighbours; 0: nothing known.
  double log_odds(const Eigen::Vector2d& p) const {
    constexpr double kPerPoint = 0.4, kMost = 6.0;
    const int i = index(p.x()), j = index(p.y());
    std::int64_t balance = 0;
    const int x = i & (kSide - 1), y = j & (kSide - 1);
    if (x > 0 && y > 0 && x + 1 < kSide && y + 1 < kSide) {  // all in one tile
      const auto tile = numbers_.find(key_of(i, j));
      if (tile == numbers_.end()) return 0;
      const Tile& cells = tiles_[tile->second];
      for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) balance += cells[cell_of(i + di, j + dj)];
      return std::clamp(kPerPoint * static_cast<double>(balance), -kMost, kMost);
    }
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di)
        if (const auto tile = numbers_.find(key_of(i + di, j + dj)); tile != numbers_.end()) balance += tiles_[tile->second][cell_of(i + di, j + dj)];
    return std::clamp(kPerPoint * static_cast<double>(balance), -kMost, kMost);
  }

 private:
  static constexpr int kShift = 5, kSide = 1 << kShift;
  using Index = std::pair<int, int>;
  using Tile = std::array<std::int32_t, kSide * kSide>;  ///< points on walls less points on objects

  int index(double x_m) const { return static_cast<int>(std::floor(x_m / resolution_m_)); }
  static std::int64_t key_of(int i, int j) {
    return static_cast<std::int64_t>(i >> kShift) * (std::int64_t{1} << 32) + (j >> kShift);
  }
  static std::size_t cell_of(int i, int j) { return static_cast<std::size_t>(((j & (kSide - 1)) << kShift) + (i & (kSide - 1))); }

  double resolution_m_;
  std::unordered_map<std::int64_t, std::size_t> numbers_;  ///< of the tiles
  std::deque<Tile> tiles_;
  std::int64_t last_key_ = 0;
  std::size_t last_ = 0;                                   ///< tile of the last point; as many as there are tiles: none
  std::vector<Index> changed_;
};

}  // namespace modslam
