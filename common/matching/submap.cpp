// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/submap.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kAverage_m = 0.12;       // map points this near to the nearest one form its surface
constexpr double kAverageCosine = 0.95;   // and their normals agree to about 18 degrees
constexpr int kMaxSide = 1500;            // cells

}  // namespace

void Submap::build(const std::vector<const Keyframe*>& keyframes, double blur_m, double widest_m) {
  std::vector<OrientedPoint> all;
  walls_.clear();
  blur_m_ = blur_m;
  widest_m_ = widest_m;
  score_grid_ready_ = false;
  for (const Keyframe* keyframe : keyframes) {
    const Eigen::Matrix2d R = rotation(keyframe->T_map_base.heading);
    const Eigen::Vector2d t = keyframe->T_map_base.translation();
    for (OrientedPoint point : keyframe->points_base) {
      point.p = R * point.p + t;
      point.n = R * point.n;
      walls_.push_back(point.p);
      if (point.has_normal()) all.push_back(point);
    }
  }

  width_ = height_ = 0;
  points_.clear();
  surfaces_.clear();
  cell_start_.assign(1, 0);
  if (all.empty()) return;
  Eigen::Vector2d low = all[0].p, high = all[0].p;
  for (const OrientedPoint& point : all) {
    low = low.cwiseMin(point.p);
    high = high.cwiseMax(point.p);
  }
  origin_ = low;
  width_ = std::min(kMaxSide, static_cast<int>((high.x() - low.x()) / kCell_m) + 1);
  height_ = std::min(kMaxSide, static_cast<int>((high.y() - low.y()) / kCell_m) + 1);
  // Counting sort by cell; stable, so the order of the keyframes decides ties.
  const auto n_cells = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  cell_start_.assign(n_cells + 1, 0);
  std::vector<int> cell(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    cell[i] = cell_of(all[i].p);
    if (cell[i] >= 0) ++cell_start_[static_cast<std::size_t>(cell[i]) + 1];
  }
  for (std::size_t c = 0; c < n_cells; ++c) cell_start_[c + 1] += cell_start_[c];
  points_.resize(static_cast<std::size_t>(cell_start_[n_cells]));
  surfaces_.resize(points_.size());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (cell[i] >= 0) points_[static_cast<std::size_t>(next[static_cast<std::size_t>(cell[i])]++)] = all[i];
}

const ScoreGrid& Submap::score_grid() const {
  if (!score_grid_ready_) score_grid_.build(walls_, blur_m_, widest_m_);
  score_grid_ready_ = true;
  return score_grid_;
}

int Submap::cell_of(const Eigen::Vector2d& p) const {
  const int x = static_cast<int>(std::floor((p.x() - origin_.x()) / kCell_m));
  const int y = static_cast<int>(std::floor((p.y() - origin_.y()) / kCell_m));
  return x >= 0 && y >= 0 && x < width_ && y < height_ ? y * width_ + x : -1;
}

template <class Visit>
void Submap::for_points_around(const Eigen::Vector2d& p, int reach, Visit&& visit) const {
  const int cx = static_cast<int>(std::floor((p.x() - origin_.x()) / kCell_m));
  const int cy = static_cast<int>(std::floor((p.y() - origin_.y()) / kCell_m));
  const int x0 = std::max(cx - reach, 0), x1 = std::min(cx + reach, width_ - 1);
  if (x0 > x1) return;
  for (int y = std::max(cy - reach, 0); y <= std::min(cy + reach, height_ - 1); ++y) {
    // Cells of a row stand side by side: their points are one run.
    const auto row = static_cast<std::size_t>(y * width_);
    const int begin = cell_start_[row + static_cast<std::size_t>(x0)], end = cell_start_[row + static_cast<std::size_t>(x1) + 1];
    for (int i = begin; i < end; ++i) visit(static_cast<std::size_t>(i));
  }
}

bool Submap::nearest_surface(const Eigen::Vector2d& p, const Eigen::Vector2d& n, double gate_m,
                             double min_cosine, Surface& out) const {
  bool found = false;
  std::size_t nearest = 0;
  double best_d2 = gate_m * gate_m;
  const int most = static_cast<int>(std::ceil(gate_m / kCell_m));
  for (int reach = 1; reach <= std::max(1, most); ++reach) {
    for_points_around(p, reach, [&](std::size_t i) {
      const double d2 = (points_[i].p - p).squaredNorm();
      if (d2 < best_d2 && points_[i].n.dot(n) >= min_cosine) {
        best_d2 = d2;
        nearest = i;
        found = true;
      }
    });
    if (found && best_d2 <= reach * reach * kCell_m * kCell_m) break;  // nothing nearer lies farther out
  }
  if (found) out = surface_at(nearest);
  return found;
}

const Surface& Submap::surface_at(std::size_t point) const {
  Surface& surface = surfaces_[point];
  if (surface.count > 0) return surface;
  const OrientedPoint& centre = points_[point];
  surface.p = surface.n = Eigen::Vector2d::Zero();
  for_points_around(centre.p, 1, [&](std::size_t i) {
    const OrientedPoint& q = points_[i];
    if ((q.p - centre.p).squaredNorm() > kAverage_m * kAverage_m || q.n.dot(centre.n) < kAverageCosine) return;
    surface.p += q.p;
    surface.n += q.n;
    surface.var_m2 += q.var_m2;
    surface.var_normal_rad2 += q.var_normal_rad2;
    ++surface.count;
  });
  surface.p /= surface.count;
  surface.n.normalize();
  surface.var_m2 /= surface.count * surface.count;
  surface.var_normal_rad2 /= surface.count * surface.count;
  return surface;
}

bool Submap::is_blocked(const Eigen::Vector2d& eye, const Eigen::Vector2d& p, double margin_m) const {
  const double length = (p - eye).norm();
  const Eigen::Vector2d u = (p - eye) / std::max(length, 1e-9);
  for (double s = 0.3; s < length - margin_m; s += 0.15) {
    const int c = cell_of(eye + s * u);
    if (c < 0) continue;
    int crossing = 0;
    for (int i = cell_start_[static_cast<std::size_t>(c)]; i < cell_start_[static_cast<std::size_t>(c) + 1]; ++i) {
      const OrientedPoint& q = points_[static_cast<std::size_t>(i)];
      const Eigen::Vector2d d = q.p - (eye + s * u);
      // Only a surface met squarely and close to the beam blocks it; a grazing one may be passed.
      const double across = std::abs(d.x() * u.y() - d.y() * u.x());
      if (across < 0.03 && std::abs(q.n.dot(u)) > 0.5) ++crossing;
    }
    if (crossing >= 2) return true;
  }
  return false;
}

}  // namespace modslam
