// SPDX-License-Identifier: BSD-3-Clause
/// @file A tiny world of segments and a laser in it, for tests of what is seen.
#pragma once
#include <cmath>
#include <random>
#include <vector>

#include "common/scan/scan.hpp"
#include "common/semantics/types.hpp"

namespace modslam::test {

struct RayWorld {
  std::vector<Segment> segments;
  double noise_m = 0.01;
  std::mt19937 random{7};

  void wall(double ax, double ay, double bx, double by) {
    segments.push_back({{ax, ay}, {bx, by}});
  }
  void box(double x0, double y0, double x1, double y1) {
    wall(x0, y0, x1, y0);
    wall(x1, y0, x1, y1);
    wall(x1, y1, x0, y1);
    wall(x0, y1, x0, y0);
  }

  double range_m(const Eigen::Vector2d& from, double angle) const {
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    double nearest = 100;
    for (const Segment& s : segments) {
      const Eigen::Vector2d e = s.b - s.a, w = s.a - from;
      const double det = d.x() * e.y() - d.y() * e.x();
      if (std::abs(det) < 1e-12) continue;
      const double t = (w.x() * e.y() - w.y() * e.x()) / det,
                   u = (w.x() * d.y() - w.y() * d.x()) / det;
      if (t > 0 && t < nearest && u >= 0 && u <= 1) nearest = t;
    }
    return nearest;
  }

  /// 360 beams all around; the noise is uniform with the standard deviation asked for.
  Scan scan(const Pose2& T_map_base) {
    Scan scan;
    scan.rad0 = -kPi;
    scan.radstep = kPi / 180;
    for (std::size_t beam = 0; beam < 360; ++beam) {
      const double range =
          range_m(T_map_base.translation(), T_map_base.heading + scan.bearing_rad(beam));
      const double draw = static_cast<double>(random()) / 4294967296.0 - 0.5;
      scan.ranges_m.push_back(
          static_cast<float>(range < 100 ? range + draw * noise_m * std::sqrt(12.0) : range));
    }
    return scan;
  }

  static SensorInfo sensor() {
    SensorInfo info;
    info.range_max_m = 30;
    return info;
  }
};

}  // namespace modslam::test
