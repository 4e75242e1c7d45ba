// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/types.hpp"

#include <algorithm>

namespace modslam {

double signed_area_m2(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    twice += p.x() * q.y() - q.x() * p.y();
  }
  return 0.5 * twice;
}

bool contains(const Polygon& polygon, const Eigen::Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    if ((p.y() > point.y()) == (q.y() > point.y())) continue;
    if (point.x() < p.x() + (point.y() - p.y()) / (q.y() - p.y()) * (q.x() - p.x()))
      inside = !inside;
  }
  return inside;
}

double distance_to_segment(const Eigen::Vector2d& point, const Segment& segment) {
  const Eigen::Vector2d along = segment.b - segment.a;
  const double squared = along.squaredNorm();
  const double t =
      squared > 0 ? std::clamp((point - segment.a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (point - segment.a - t * along).norm();
}

}  // namespace modslam
