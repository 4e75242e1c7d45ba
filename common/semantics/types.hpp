// SPDX-License-Identifier: BSD-3-Clause
/// @file What the semantic map is made of. Map frame, metres. Ids are positive and stable over
/// updates; 0 means none.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace modslam {

using Polygon = std::vector<Eigen::Vector2d>;  ///< counter-clockwise, first corner not repeated

struct Segment {
  Eigen::Vector2d a, b;

  double length_m() const { return (b - a).norm(); }
  Eigen::Vector2d direction() const { return (b - a).normalized(); }
  Eigen::Vector2d centre() const { return 0.5 * (a + b); }
};

/// A straight wall face. The two faces of one wall are two of these.
struct Wall {
  std::int64_t id = 0;
  Segment segment;
  double evidence = 0;  ///< mean log-odds of being wall along it
  double sigma_m = 0;   ///< standard deviation of its points across it
};

/// An opening that a robot can pass, jamb to jamb.
struct Door {
  std::int64_t id = 0;
  Segment segment;
  double evidence = 0;                  ///< log-odds
  std::int64_t room_a = 0, room_b = 0;  ///< rooms on its two sides

  double width_m() const { return segment.length_m(); }
};

enum class RoomType { kRoom = 1, kCorridor = 2 };

struct Room {
  std::int64_t id = 0;
  std::string name;
  RoomType type = RoomType::kRoom;
  double area_m2 = 0;
  double explored = 0;  ///< 0..1 share of its area that was seen
  double evidence = 0;  ///< mean log-odds of its walls
  Polygon outline;
};

/// Something that is not wall.
struct Object {
  std::int64_t id = 0;
  std::string class_name;  ///< empty: unknown
  double area_m2 = 0;
  double evidence = 0;  ///< mean log-odds of not being wall
  std::int64_t first_utime = 0, last_utime = 0;
  Polygon outline;
};

struct Semantics {
  std::vector<Wall> walls;
  std::vector<Room> rooms;
  std::vector<Door> doors;
  std::vector<Object> objects;
};

/// Signed by orientation: positive when counter-clockwise.
double signed_area_m2(const Polygon& polygon);
/// Even-odd rule.
bool contains(const Polygon& polygon, const Eigen::Vector2d& point);
double distance_to_segment(const Eigen::Vector2d& point, const Segment& segment);

}  // namespace modslam
