// SPDX-License-Identifier: BSD-3-Clause
/// @file Plans of a few walls and what a laser would see in them; noise from literal seeds.
#pragma once
#include <vector>

#include "common/scan/scan.hpp"
#include "common/world/random.hpp"

namespace modslam::test {

struct Wall {
  Eigen::Vector2d a, b;
};
using Plan = std::vector<Wall>;

/// Walls of an axis-parallel box.
inline void add_box(Plan& plan, double x0, double y0, double x1, double y1) {
  const Eigen::Vector2d p[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  for (int k = 0; k < 4; ++k) plan.push_back({p[k], p[(k + 1) % 4]});
}

/// 8 x 6 m around the origin with a cupboard, a table, a crate and a slanted board: no two places look alike.
inline Plan furnished_room() {
  Plan plan;
  add_box(plan, -4, -3, 4, 3);
  add_box(plan, -4, 1.8, -2.6, 3);
  add_box(plan, 1.2, -2.2, 2.6, -1.4);
  add_box(plan, -2.4, -2.6, -1.9, -2.1);
  plan.push_back({{2.6, 3}, {4, 1.4}});
  return plan;
}

/// Two bare walls along x, 2.5 m apart, longer than the laser sees: nothing tells where along it one is.
inline Plan corridor() { return {{{-200, -1.25}, {200, -1.25}}, {{-200, 1.25}, {200, 1.25}}}; }

/// A laser of 361 beams over the whole circle, 10 m.
inline SensorInfo short_laser() {
  SensorInfo sensor;
  sensor.range_max_m = 10.0;
  return sensor;
}

/// First crossing of a ray with the plan, or `max_m`.
inline double cast_ray(const Plan& plan, const Eigen::Vector2d& eye, double bearing_rad, double max_m) {
  const Eigen::Vector2d u(std::cos(bearing_rad), std::sin(bearing_rad));
  double nearest = max_m;
  for (const Wall& wall : plan) {
    const Eigen::Vector2d w = wall.b - wall.a, d = wall.a - eye;
    const double cross = u.x() * w.y() - u.y() * w.x();
    if (std::abs(cross) < 1e-12) continue;
    const double range = (d.x() * w.y() - d.y() * w.x()) / cross, share = (d.x() * u.y() - d.y() * u.x()) / cross;
    if (range > 0 && share >= 0 && share <= 1 && range < nearest) nearest = range;
  }
  return nearest;
}

/// What the laser measures at a place. @param random adds 1 cm of range noise; none: exact.
inline Scan see(const Plan& plan, const SensorInfo& sensor, const Pose2& T_map_base, RandomStream* random = nullptr,
                std::int64_t utime = 0) {
  constexpr std::size_t kBeams = 361;
  Scan scan;
  scan.utime = utime;
  scan.rad0 = -kPi;
  scan.radstep = 2 * kPi / kBeams;
  const Pose2 T_map_laser = T_map_base * sensor.T_base_laser;
  for (std::size_t k = 0; k < kBeams; ++k) {
    double range_m = cast_ray(plan, T_map_laser.translation(), T_map_laser.heading + scan.bearing_rad(k), sensor.range_max_m);
    if (random && range_m < sensor.range_max_m) range_m += 0.01 * random->normal();
    scan.ranges_m.push_back(static_cast<float>(range_m));
  }
  return scan;
}

}  // namespace modslam::test
