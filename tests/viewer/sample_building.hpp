// SPDX-License-Identifier: BSD-3-Clause
/// @file A made-up building of five rooms and a corridor, and what a robot that wanders through it
/// would see.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/pose2.hpp"

namespace modslam::sample {

struct Segment {
  double ax, ay, bx, by;
};
struct Room {
  const char* name;
  bool corridor;
  double x0, y0, x1, y1;
};
struct Door {
  Segment opening;
  int room_a, room_b;  ///< numbers in kRooms, from 1
  bool open;
};

/// The last name is what a message must never be able to do to the page.
inline const std::vector<Room> kRooms = {
    {"Library", false, 0, 2, 5, 6},
    {"Kitchen", false, 5, 2, 8, 6},
    {"Workshop", false, 8, 2, 13, 6},
    {"", false, 0, -4, 6, 0},
    {"<img src=x onerror=\"window.hacked=1\">", false, 6, -4, 13, 0},
    {"Corridor", true, 0, 0, 13, 2}};
inline const std::vector<Door> kDoors = {
    {{2, 2, 2.9, 2}, 1, 6, true},   {{6, 2, 6.9, 2}, 2, 6, true}, {{10, 2, 11, 2}, 3, 6, true},
    {{2.5, 0, 3.4, 0}, 4, 6, true}, {{9, 0, 10, 0}, 5, 6, true},  {{8, 3.6, 8, 4.5}, 2, 3, false}};
inline const std::vector<Segment> kWalls = {
    {0, -4, 13, -4}, {13, -4, 13, 6}, {13, 6, 0, 6},  {0, 6, 0, -4},  {6, -4, 6, 0},
    {5, 2, 5, 6},    {8, 2, 8, 3.6},  {8, 4.5, 8, 6}, {0, 2, 2, 2},   {2.9, 2, 6, 2},
    {6.9, 2, 10, 2}, {11, 2, 13, 2},  {0, 0, 2.5, 0}, {3.4, 0, 9, 0}, {10, 0, 13, 0}};
inline const std::vector<std::array<double, 4>> kTables = {{1.0, 4.4, 2.6, 5.4},
                                                           {9.4, -3.0, 11.0, -2.2}};
inline const std::vector<std::pair<double, double>> kRoute = {
    {1, 1},      {2.4, 1},    {2.4, 3.4},  {4, 4},     {2.4, 3.2}, {2.4, 1},  {2.9, -0.8},
    {4.5, -2.5}, {1.5, -2},   {2.9, -0.8}, {3, 1},     {6.4, 1},   {6.4, 4},  {6.4, 1},
    {9.5, 1},    {9.5, -1.2}, {8, -3},     {12, -3.5}, {12, -1},   {9.5, -1}, {9.5, 1},
    {10.5, 1},   {10.5, 3.5}, {12, 5},     {9, 4},     {10.5, 3},  {10.5, 1}, {1, 1}};

/// Where the robot is after `way_m` metres; the route begins again at its end.
inline Pose2 on_route(double way_m) {
  double length = 0;
  for (std::size_t i = 1; i < kRoute.size(); ++i)
    length +=
        std::hypot(kRoute[i].first - kRoute[i - 1].first, kRoute[i].second - kRoute[i - 1].second);
  double rest = std::fmod(way_m, length);
  for (std::size_t i = 1;; ++i) {
    const auto [ax, ay] = kRoute[i - 1];
    const auto [bx, by] = kRoute[i];
    const double leg = std::hypot(bx - ax, by - ay);
    if (rest <= leg || i + 1 == kRoute.size())
      return {ax + (bx - ax) * rest / leg, ay + (by - ay) * rest / leg,
              std::atan2(by - ay, bx - ax)};
    rest -= leg;
  }
}

/// Everything a beam can hit, walls first.
inline const std::vector<Segment>& obstacles() {
  static const std::vector<Segment> all = [] {
    std::vector<Segment> list = kWalls;
    for (const Door& door : kDoors)
      if (!door.open) list.push_back(door.opening);
    for (const auto& [x0, y0, x1, y1] : kTables)
      for (const Segment& side :
           {Segment{x0, y0, x1, y0}, {x1, y0, x1, y1}, {x1, y1, x0, y1}, {x0, y1, x0, y0}})
        list.push_back(side);
    return list;
  }();
  return all;
}

/// Distance along a ray to the first obstacle, and which it is. Infinite where a ray slips through
/// a corner.
inline std::pair<double, std::size_t> cast_ray(double x, double y, double angle_rad) {
  const double dx = std::cos(angle_rad), dy = std::sin(angle_rad);
  std::pair<double, std::size_t> nearest{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t i = 0; i < obstacles().size(); ++i) {
    const Segment& s = obstacles()[i];
    const double ex = s.bx - s.ax, ey = s.by - s.ay, det = dx * ey - dy * ex;
    if (std::abs(det) < 1e-12) continue;
    const double along = ((s.ax - x) * ey - (s.ay - y) * ex) / det;
    const double across = ((s.ax - x) * dy - (s.ay - y) * dx) / det;
    if (along > 0 && across >= 0 && across <= 1 && along < nearest.first) nearest = {along, i};
  }
  return nearest;
}

/// A grid of log-odds in square tiles that grows where beams go.
class TiledGrid {
 public:
  static constexpr int kCells = 128;
  static constexpr double kResolution_m = 0.05;
  using Key = std::pair<int, int>;

  void add_beam(double x, double y, double angle_rad, double range_m) {
    const double dx = std::cos(angle_rad), dy = std::sin(angle_rad);
    for (double r = 0; r < range_m - kResolution_m; r += kResolution_m)
      add(x + r * dx, y + r * dy, -0.4);
    add(x + range_m * dx, y + range_m * dy, 1.2);
  }

  /// The cells of a tile as map_tile_t wants them.
  std::vector<std::uint8_t> bytes(const Key& key) const {
    std::vector<std::uint8_t> cells;
    for (const double odds : tiles_.at(key))
      cells.push_back(
          odds == 0 ? std::uint8_t{0}
                    : static_cast<std::uint8_t>(1 + std::lround(254.0 / (1.0 + std::exp(-odds)))));
    return cells;
  }
  std::set<Key> take_changed() { return std::exchange(changed_, {}); }
  void mark_all_changed() {
    for (const auto& [key, cells] : tiles_) changed_.insert(key);
  }

 private:
  void add(double x, double y, double odds) {
    const int col = static_cast<int>(std::floor(x / kResolution_m)),
              row = static_cast<int>(std::floor(y / kResolution_m));
    const auto floor_div = [](int a) {
      return a >= 0 ? a / kCells : -((-a + kCells - 1) / kCells);
    };
    const Key key{floor_div(col), floor_div(row)};
    auto& cells = tiles_[key];
    cells.resize(kCells * kCells, 0.0);
    double& cell = cells[static_cast<std::size_t>((row - key.second * kCells) * kCells + col -
                                                  key.first * kCells)];
    cell = std::clamp(cell + odds, -4.0, 4.0);
    changed_.insert(key);
  }

  std::map<Key, std::vector<double>> tiles_;
  std::set<Key> changed_;
};

}  // namespace modslam::sample
