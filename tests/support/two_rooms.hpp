// SPDX-License-Identifier: BSD-3-Clause
/// @file Two rooms of 4 x 6 m side by side, a wall of 0.16 m between them, a door of 0.9 m in its middle, at the origin.
#pragma once
#include "tests/support/synthetic_scan.hpp"

namespace modslam::test {

inline Plan two_rooms() {
  constexpr double kHalfWall = 0.08, kHalfDoor = 0.45;
  Plan plan;
  add_box(plan, -4, -3, 4, 3);
  for (const double x : {-kHalfWall, kHalfWall}) {
    plan.push_back({{x, -3}, {x, -kHalfDoor}});
    plan.push_back({{x, kHalfDoor}, {x, 3}});
  }
  for (const double y : {-kHalfDoor, kHalfDoor}) plan.push_back({{-kHalfWall, y}, {kHalfWall, y}});
  return plan;
}

/// A loop in the left room, through the door, a loop in the right room: steps of about 0.4 m.
inline std::vector<Pose2> drive_through_two_rooms() {
  const std::vector<Eigen::Vector2d> corners = {{-1, 0},    {-1.2, -1.8}, {-2.8, -1.8}, {-2.8, 1.8}, {-1.2, 1.8}, {-1, 0},
                                                {1, 0},     {1.2, 1.8},   {2.8, 1.8},   {2.8, -1.8}, {1.2, -1.8}, {1, 0}};
  std::vector<Pose2> places;
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    const Eigen::Vector2d d = corners[k + 1] - corners[k];
    const int steps = static_cast<int>(std::ceil(d.norm() / 0.4));
    for (int j = 0; j < steps; ++j) {
      const Eigen::Vector2d p = corners[k] + d * j / steps;
      places.push_back({p.x(), p.y(), std::atan2(d.y(), d.x())});
    }
  }
  return places;
}

}  // namespace modslam::test
