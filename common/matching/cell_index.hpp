// SPDX-License-Identifier: BSD-3-Clause
/// @file Points of the plane ordered by square cells, for "what lies around here?"
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
    width_ = height_ = 0;
    points_.clear();
    start_.assign(1, 0);
    if (all.empty()) return;
    Eigen::Vector2d low = all[0].p, high = all[0].p;
    for (const Point& point : all) {
      low = low.cwiseMin(point.p);
      high = high.cwiseMax(point.p);
    }
    origin_ = low;
    width_ = std::min(kMaxSide, static_cast<int>((high.x() - low.x()) / cell_m_) + 1);
    height_ = std::min(kMaxSide, static_cast<int>((high.y() - low.y()) / cell_m_) + 1);
    sort(all);
  }

  const std::vector<Point>& points() const { return points_; }

  /// Visits the indices into points() of the cells up to `reach` cells around the one of `p`.
  template <class Visit>
  void for_points_around(const Eigen::Vector2d& p, int reach, Visit&& visit) const {
    const int cx = column(p), cy = row(p);
    const int x0 = std::max(cx - reach, 0), x1 = std::min(cx + reach, width_ - 1);
    if (x0 > x1) return;
    for (int y = std::max(cy - reach, 0); y <= std::min(cy + reach, height_ - 1); ++y) {
      // Cells of a row stand side by side: their points are one run.
      const auto first = static_cast<std::size_t>(y * width_);
      const int begin = start_[first + static_cast<std::size_t>(x0)], end = start_[first + static_cast<std::size_t>(x1) + 1];
      for (int i = begin; i < end; ++i) visit(static_cast<std::size_t>(i));
    }
  }

 private:
  /// Counting sort by cell; stable, so the order of arrival decides ties.
  void sort(const std::vector<Point>& all) {
    const auto n_cells = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
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
  int cell_of(const Eigen::Vector2d& p) const {
    const int x = column(p), y = row(p);
    return x >= 0 && y >= 0 && x < width_ && y < height_ ? y * width_ + x : -1;
  }

  static constexpr int kMaxSide = 1500;  // cells
  double cell_m_;
  std::vector<Point> points_;
  std::vector<int> start_{0};  ///< width * height + 1 offsets into points_
  Eigen::Vector2d origin_{0, 0};
  int width_ = 0, height_ = 0;
};

}  // namespace modslam
