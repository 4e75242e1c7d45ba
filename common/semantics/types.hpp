// SPDX-License-Identifier: BSD-3-Clause
/// @file What the semantic map is made of. Map frame, metres.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/places/place.hpp"

namespace modslam {

/// Corners of a polygon in order. Copies share them: most polygons stay as they are from one update to the next.
class Corners {
 public:
  using Points = std::vector<Eigen::Vector2d>;
  Corners() = default;
  Corners(Points points) : points_(points.empty() ? nullptr : std::make_shared<const Points>(std::move(points))) {}
  Corners(std::initializer_list<Eigen::Vector2d> points) : Corners(Points(points)) {}
  operator const Points&() const {
    static const Points none;
    return points_ ? *points_ : none;
  }
  const Points& points() const { return *this; }
  auto begin() const { return points().begin(); }
  auto end() const { return points().end(); }
  std::size_t size() const { return points().size(); }
  bool empty() const { return !points_; }
  const Eigen::Vector2d& operator[](std::size_t k) const { return (*points_)[k]; }
  bool operator==(const Corners& o) const { return points_ == o.points_ || points() == o.points(); }
  bool operator!=(const Corners& o) const { return !(*this == o); }

 private:
  std::shared_ptr<const Points> points_;
};

/// How well it is known where a wall ends: standard deviations.
struct WallEnd {
  double across_m = 0;       ///< of the place of its line there
  double along_m = 0;        ///< of the place where it ends
  bool seen = false;         ///< whether what comes after it was seen; if not, the wall may go on
};

/// One face of a straight wall, as a laser sees it; the other face of the same wall is another one.
struct Wall {
  std::int64_t id = 0;
  Eigen::Vector2d a, b;      ///< ends; the free side lies to the left of a -> b
  double evidence = 0;       ///< mean log-odds of wall against object along it
  double sigma_m = 0;        ///< scatter of its points across it
  WallEnd at_a, at_b;
  bool on_object = false;    ///< something that stands free lies right behind most of it
  double length_m() const { return (b - a).norm(); }
  Eigen::Vector2d direction() const { return (b - a).normalized(); }
  Eigen::Vector2d normal() const { const Eigen::Vector2d u = direction(); return {-u.y(), u.x()}; }  ///< towards the free side
};

struct Door {
  std::int64_t id = 0;
  Eigen::Vector2d a, b;      ///< jambs
  double evidence = 0;       ///< log-odds
  bool closed = false;
  std::int64_t room_a = 0, room_b = 0;  ///< 0: none known
  int region_a = 0, region_b = 0;       ///< on its two sides, in the parted floor it was found on
  double width_m() const { return (b - a).norm(); }
  Eigen::Vector2d centre() const { return 0.5 * (a + b); }
};

/// A region enclosed by walls and doors. A hole (a block in a ring corridor) is part of the outline: a cut of no width leads to it.
struct Room {
  std::int64_t id = 0;
  std::string name;
  bool corridor = false;
  double area_m2 = 0, explored = 0;  ///< explored: share of the area that was seen
  double evidence = 0;               ///< share of the outline that lies on walls and openings
  int region = 0;                    ///< in the parted floor it was found on
  Corners outline;
};

/// Rooms that became others from one update to the next.
struct RoomEvent {
  enum class Kind { kSplit, kMerge };
  Kind kind = Kind::kSplit;
  std::vector<std::int64_t> before, after;  ///< ids, rising; one before a split, one after a merge
};

struct Object {
  std::int64_t id = 0;
  std::string class_name;    ///< "": unknown
  double class_confidence = 0;  ///< 0..1; 0 when unknown
  double area_m2 = 0, evidence = 0;
  Corners outline;
};

struct SemanticLayers {
  std::vector<Wall> walls;
  std::vector<Door> doors;
  std::vector<Room> rooms;
  std::vector<RoomEvent> room_events;  ///< what became of the rooms of the update before
  std::vector<Object> objects;
  std::vector<Place> places;  ///< of the pose graph's nodes; none on a finished map
};

}  // namespace modslam
