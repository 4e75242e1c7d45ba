// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/submap.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kAverage_m = 0.12;       // map points this near to the nearest one form its surface
constexpr double kAverageCosine = 0.95;   // and their normals agree to about 18 degrees

}  // namespace

void Submap::build(const std::vector<const Keyframe*>& keyframes, double blur_m, double widest_m) {
  std::vector<OrientedPoint> all;
  walls_.clear();
  blur_m_ = blur_m;
  widest_m_ = widest_m;
  score_grid_.reset();
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

  index_.build(all);
  surfaces_.assign(index_.points().size(), {});
}

const ScoreGrid& Submap::score_grid() const {
  if (!score_grid_) score_grid_.emplace().build(walls_, blur_m_, widest_m_);
  return *score_grid_;
}

bool Submap::nearest_surface(const Eigen::Vector2d& p, const Eigen::Vector2d& n, double gate_m,
                             double min_cosine, Surface& out) const {
  const std::vector<OrientedPoint>& points = index_.points();
  bool found = false;
  std::size_t nearest = 0;
  double best_d2 = gate_m * gate_m;
  const int most = static_cast<int>(std::ceil(gate_m / kCell_m));
  for (int reach = 1; reach <= std::max(1, most); ++reach) {
    index_.for_points_around(p, reach, [&](std::size_t i) {
      const double d2 = (points[i].p - p).squaredNorm();
      if (d2 < best_d2 && points[i].n.dot(n) >= min_cosine) {
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
  const OrientedPoint& centre = index_.points()[point];
  surface.p = surface.n = Eigen::Vector2d::Zero();
  index_.for_points_around(centre.p, 1, [&](std::size_t i) {
    const OrientedPoint& q = index_.points()[i];
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
    int crossing = 0;
    index_.for_points_around(eye + s * u, 0, [&](std::size_t i) {
      const OrientedPoint& q = index_.points()[i];
      const Eigen::Vector2d d = q.p - (eye + s * u);
      // Only a surface met squarely and close to the beam blocks it; a grazing one may be passed.
      const double across = std::abs(d.x() * u.y() - d.y() * u.x());
      if (across < 0.03 && std::abs(q.n.dot(u)) > 0.5) ++crossing;
    });
    if (crossing >= 2) return true;
  }
  return false;
}

}  // namespace modslam
