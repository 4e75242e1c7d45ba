// SPDX-License-Identifier: BSD-3-Clause
/// @file Points of the plane ordered by square cells, for "what lies around here?"
///
/// A row has cells from its first point to its last one only: what a building takes does not depend on how its walls lie to the axes.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace modslam {

/// `Point` has a member `p`, its place [m]. Points of one cell keep the order in which they came.
/// Points that would make a side longer than kMaxSide cells are left out.
template <class Point>
class CellIndex {
 public:
  explicit CellIndex(double cell_m) : cell_m_(cell_m) {}

  /// Replaces the content. Cost O(points + cells).
  void build(const std::vector<Point>& all) {
    points_.clear();
    rows_.clear();
    start_.assign(1, 0);
    if (all.empty()) return;
    Eigen::Vector2d low = all[0].p, high = all[0].p;
    for (const Point& point : all) {
      low = low.cwiseMin(point.p);
      high = high.cwiseMax(point.p);
    }
    origin_ = low;
    rows_.resize(static_cast<std::size_t>(std::min(kMaxSide, static_cast<int>((high.y() - low.y()) / cell_m_) + 1)));
    sort(all, lay_out(all));
  }

  const std::vector<Point>& points() const { return points_; }
  std::size_t cells() const { return start_.size() - 1; }

  /// Visits the indices into points() of the cells up to `reach` cells around the one of `p`.
  template <class Visit>
  void for_points_around(const Eigen::Vector2d& p, int reach, Visit&& visit) const {
    const int cx = column(p), cy = row(p);
    for (int y = std::max(cy - reach, 0); y <= std::min(cy + reach, static_cast<int>(rows_.size()) - 1); ++y) {
      // Cells of a row stand side by side: their points are one run.
      const Row& cells = rows_[static_cast<std::size_t>(y)];
      const int x0 = std::max(cx - reach, cells.first), x1 = std::min(cx + reach, cells.last);
      if (x0 > x1) continue;
      const int begin = start_[static_cast<std::size_t>(cells.offset + x0)], end = start_[static_cast<std::size_t>(cells.offset + x1) + 1];
      for (int i = begin; i < end; ++i) visit(static_cast<std::size_t>(i));
    }
  }

 private:
  struct Row {
    int first = kMaxSide, last = -1;  ///< columns; none yet
    int offset = 0;                   ///< of column 0 in start_, were it there
  };

  /// Finds the rows. @return the number of cells.
  std::size_t lay_out(const std::vector<Point>& all) {
    for (const Point& point : all) {
      const int x = column(point.p), y = row(point.p);
      if (!inside(x, y)) continue;
      Row& cells = rows_[static_cast<std::size_t>(y)];
      cells.first = std::min(cells.first, x);
      cells.last = std::max(cells.last, x);
    }
    int n_cells = 0;
    for (Row& cells : rows_) {
      if (cells.last < cells.first) continue;
      cells.offset = n_cells - cells.first;
      n_cells += cells.last - cells.first + 1;
    }
    return static_cast<std::size_t>(n_cells);
  }

  /// Counting sort by cell; stable, so the order of arrival decides ties.
  void sort(const std::vector<Point>& all, std::size_t n_cells) {
    start_.assign(n_cells + 1, 0);
    std::vector<int> cell(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      cell[i] = cell_of(all[i].p);
      if (cell[i] >= 0) ++start_[static_cast<std::size_t>(cell[i]) + 1];
    }
    for (std::size_t c = 0; c < n_cells; ++c) start_[c + 1] += start_[c];
    points_.resize(static_cast<std::size_t>(start_[n_cells]));
    std::vector<int> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (cell[i] >= 0) points_[static_cast<std::size_t>(next[static_cast<std::size_t>(cell[i])]++)] = all[i];
  }

  int column(const Eigen::Vector2d& p) const { return static_cast<int>(std::floor((p.x() - origin_.x()) / cell_m_)); }
  int row(const Eigen::Vector2d& p) const { return static_cast<int>(std::floor((p.y() - origin_.y()) / cell_m_)); }
  bool inside(int x, int y) const { return x >= 0 && x < kMaxSide && y >= 0 && y < static_cast<int>(rows_.size()); }
  int cell_of(const Eigen::Vector2d& p) const {
    const int x = column(p), y = row(p);
    return inside(x, y) ? rows_[static_cast<std::size_t>(y)].offset + x : -1;
  }

  static constexpr int kMaxSide = 1500;  // cells
  double cell_m_;
  std::vector<Point> points_;
  std::vector<Row> rows_;
  std::vector<int> start_{0};  ///< of each cell in points_, and where the last one ends
  Eigen::Vector2d origin_{0, 0};
};

}  // namespace modslam
