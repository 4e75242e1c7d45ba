// SPDX-License-Identifier: BSD-3-Clause
/// @file Evidence for wall or object, cell by cell, as log-odds (thesis 3.4.1). Counts, so that a scan can be taken out exactly.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace modslam {

class EvidenceGrid {
 public:
  explicit EvidenceGrid(double resolution_m = 0.05) : resolution_m_(resolution_m) {}

  /// One scan point at p [m], on a straight piece or not; sign -1 takes it back.
  void add(const Eigen::Vector2d& p, bool on_line, int sign) {
    Counts& counts = cells_[key(p)];
    (on_line ? counts.wall : counts.object) += sign;
    if (counts.wall == 0 && counts.object == 0) cells_.erase(key(p));
  }
  /// Log-odds of wall against object at p, over the cell and its neighbours; 0: nothing known.
  double log_odds(const Eigen::Vector2d& p) const {
    constexpr double kPerPoint = 0.4, kMost = 6.0;
    std::int64_t balance = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const auto cell = cells_.find(key(p + resolution_m_ * Eigen::Vector2d(dx, dy)));
        if (cell != cells_.end()) balance += cell->second.wall - cell->second.object;
      }
    return std::max(-kMost, std::min(kMost, kPerPoint * static_cast<double>(balance)));
  }
  bool empty() const { return cells_.empty(); }
  void clear() { cells_.clear(); }

 private:
  struct Counts {
    std::int32_t wall = 0, object = 0;
  };
  std::int64_t key(const Eigen::Vector2d& p) const {
    const auto x = static_cast<std::int64_t>(std::floor(p.x() / resolution_m_)), y = static_cast<std::int64_t>(std::floor(p.y() / resolution_m_));
    return (x << 32) ^ (y & 0xffffffff);
  }
  double resolution_m_;
  std::unordered_map<std::int64_t, Counts> cells_;
};

}  // namespace modslam
