// SPDX-License-Identifier: BSD-3-Clause
/// @file A semantic map as its GeoJSON file carries it: what a run found, or what a simulated world
/// holds.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// Standard deviations of where a wall ends.
struct MapWallEnd {
  double across_m = 0, along_m = 0;
  bool seen = false;  ///< what comes after it was seen
};

struct MapWall {
  Eigen::Vector2d a, b;
  double thickness_m =
      0;  ///< > 0: a and b are its middle line, and its two faces are what a laser sees
  std::vector<MapWallEnd> ends{};  ///< at a and b; none: nothing is told of them
};

/// A region with holes, such as a corridor that runs round a block. Rings are not repeated at their
/// end.
struct MapPolygon {
  std::vector<Eigen::Vector2d> outline;
  std::vector<std::vector<Eigen::Vector2d>> holes;
};

struct MapRoom {
  std::string id;
  MapPolygon polygon;
};

struct MapDoor {
  std::string id;
  Eigen::Vector2d a, b;  ///< jambs
  bool closed = false;
  bool rooms_known = false;
  std::string room_a, room_b;  ///< ids; "" is the outside or nothing known

  Eigen::Vector2d centre() const { return 0.5 * (a + b); }
  double width_m() const { return (b - a).norm(); }
};

struct MapObject {
  MapPolygon polygon;
  std::string class_name;  ///< "": not named
};

struct SemanticMap {
  std::vector<MapWall> walls;
  std::vector<MapRoom> rooms;
  std::vector<MapDoor> doors;
  std::vector<MapObject> objects;
};

/// Features with properties.kind wall, room, door, object; other kinds are passed over. A
/// LineString of more than two points is that many walls.
/// @throws std::runtime_error naming the feature (from 1) and what is wrong with it.
SemanticMap parse_semantic_map(const std::string& geojson);

/// The same map in another frame: every point p becomes T * p.
SemanticMap transformed(const Pose2& T, SemanticMap map);

/// Areas by GEOS; outlines that cross themselves are repaired first. 0 for what has no area.
double area_m2(const MapPolygon& polygon);
double overlap_m2(const MapPolygon& p, const MapPolygon& q);

/// Even-odd rule.
bool contains(const MapPolygon& polygon, const Eigen::Vector2d& point);

}  // namespace modslam
