// SPDX-License-Identifier: BSD-3-Clause
/// @file Known floor drawn by hand: rectangles in metres on a raster of 0.1 m.
#pragma once
#include <opencv2/imgproc.hpp>

#include "common/semantics/known_space.hpp"
#include "common/semantics/types.hpp"

namespace modslam::test {

constexpr std::uint8_t kUnknown = 0, kFree = 10, kSolid = 250;

/// All unknown, from (0, 0) to (width_m, height_m).
inline KnownSpace unknown_floor(double width_m, double height_m) {
  KnownSpace space(0.1);
  space.occupancy = cv::Mat1b(static_cast<int>(std::lround(height_m / 0.1)), static_cast<int>(std::lround(width_m / 0.1)), kUnknown);
  return space;
}

/// Fills [x0, x1) x [y0, y1).
inline void fill(KnownSpace& space, double x0, double y0, double x1, double y1, std::uint8_t value) {
  const auto cells = [](double metres) { return static_cast<int>(std::lround(metres / 0.1)); };
  space.occupancy(cv::Rect(cells(x0), cells(y0), cells(x1 - x0), cells(y1 - y0))).setTo(value);
}

/// Occupied rim of one cell, unknown inside: what a laser knows of a thing it went round.
inline void fill_thing(KnownSpace& space, double x0, double y0, double x1, double y1) {
  fill(space, x0, y0, x1, y1, kSolid);
  if (x1 - x0 > 0.25 && y1 - y0 > 0.25) fill(space, x0 + 0.1, y0 + 0.1, x1 - 0.1, y1 - 0.1, kUnknown);
}

/// Four wall faces whose free side is inside the box (or outside it).
inline void add_faces(std::vector<Wall>& walls, double x0, double y0, double x1, double y1, bool free_inside = true) {
  const Eigen::Vector2d p[] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  for (int k = 0; k < 4; ++k) {
    Wall wall;
    wall.a = p[free_inside ? k : (k + 1) % 4];
    wall.b = p[free_inside ? (k + 1) % 4 : k];
    walls.push_back(wall);
  }
}

}  // namespace modslam::test
