// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/semantic_map.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace modslam {
namespace {

using nlohmann::json;
using Ring = std::vector<Eigen::Vector2d>;

Eigen::Vector2d point_of(const json& coordinates) {
  if (!coordinates.is_array() || coordinates.size() < 2)
    throw std::runtime_error("a point is no pair of numbers");
  const Eigen::Vector2d p(coordinates.at(0).get<double>(), coordinates.at(1).get<double>());
  if (!(p.cwiseAbs().maxCoeff() < 1e6)) throw std::runtime_error("a point is not within 1e6 m");
  return p;
}

Ring points_of(const json& coordinates, std::size_t at_least) {
  Ring points;
  for (const json& c : coordinates) points.push_back(point_of(c));
  if (points.size() < at_least)
    throw std::runtime_error("has " + std::to_string(points.size()) +
                             " points, expected at least " + std::to_string(at_least));
  return points;
}

Ring ring_of(const json& coordinates) {
  Ring ring = points_of(coordinates, 3);
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3) throw std::runtime_error("a ring has fewer than three corners");
  return ring;
}

MapPolygon polygon_of(const json& geometry) {
  const json& rings = geometry.at("coordinates");
  if (geometry.at("type") != "Polygon" || rings.empty())
    throw std::runtime_error("is no Polygon with a ring");
  MapPolygon polygon;
  polygon.outline = ring_of(rings.at(0));
  for (std::size_t i = 1; i < rings.size(); ++i) polygon.holes.push_back(ring_of(rings.at(i)));
  return polygon;
}

Ring line_of(const json& geometry) {
  if (geometry.at("type") != "LineString") throw std::runtime_error("is no LineString");
  return points_of(geometry.at("coordinates"), 2);
}

/// Ids are numbers in some files and words in others; 0, "" and null mean none.
std::string id_of(const json& value) {
  if (value.is_null() || value == 0) return "";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

MapDoor door_of(const json& properties, const json& geometry) {
  const Ring line = line_of(geometry);
  MapDoor door;
  door.id = id_of(properties.value("id", json()));
  door.a = line.front();
  door.b = line.back();
  door.closed = properties.value("state", json()) == "closed";
  const json rooms = properties.value("rooms", json());
  if (!rooms.is_array() || rooms.size() != 2) return door;
  door.rooms_known = true;
  door.room_a = id_of(rooms[0]);
  door.room_b = id_of(rooms[1]);
  return door;
}

std::vector<MapWallEnd> ends_of(const json& told) {
  std::vector<MapWallEnd> ends;
  for (const json& end : told) {
    ends.push_back({end.at("across_m").get<double>(), end.at("along_m").get<double>(), end.at("seen").get<bool>()});
    if (!(ends.back().across_m >= 0 && ends.back().along_m >= 0)) throw std::runtime_error("has an end whose standard deviation is no length");
  }
  if (ends.size() != 0 && ends.size() != 2) throw std::runtime_error("has " + std::to_string(ends.size()) + " ends, expected 2");
  return ends;
}

void add_walls(const json& properties, const json& geometry, SemanticMap& map) {
  const Ring line = line_of(geometry);
  const double thickness_m = properties.value("thickness_m", properties.value("thickness", 0.0));
  if (!(thickness_m >= 0 && thickness_m < 5))
    throw std::runtime_error("has a thickness outside [0, 5) m");
  for (std::size_t i = 1; i < line.size(); ++i)
    map.walls.push_back({line[i - 1], line[i], thickness_m, {}});
  if (line.size() == 2) map.walls.back().ends = ends_of(properties.value("ends", json::array()));
}

void add_feature(const json& feature, SemanticMap& map) {
  const json& properties = feature.at("properties");
  const std::string kind = properties.is_object() ? properties.value("kind", "") : "";
  const json& geometry = feature.at("geometry");
  if (kind == "wall") add_walls(properties, geometry, map);
  if (kind == "room")
    map.rooms.push_back({id_of(properties.value("id", json())), polygon_of(geometry)});
  if (kind == "door") map.doors.push_back(door_of(properties, geometry));
  if (kind == "object" && geometry.at("type") == "Polygon")
    map.objects.push_back({polygon_of(geometry), id_of(properties.value("class", json()))});
}

bool inside(const Ring& ring, const Eigen::Vector2d& p) {
  bool odd = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
    if ((ring[i].y() > p.y()) != (ring[j].y() > p.y()) &&
        p.x() < ring[i].x() + (ring[j].x() - ring[i].x()) * (p.y() - ring[i].y()) /
                                  (ring[j].y() - ring[i].y()))
      odd = !odd;
  return odd;
}

void transform(const Pose2& T, MapPolygon& polygon) {
  for (Eigen::Vector2d& p : polygon.outline) p = T * p;
  for (Ring& hole : polygon.holes)
    for (Eigen::Vector2d& p : hole) p = T * p;
}

}  // namespace

SemanticMap parse_semantic_map(const std::string& geojson) {
  const json document = json::parse(geojson, nullptr, false);
  if (document.is_discarded()) throw std::runtime_error("is not JSON");
  if (!document.is_object() || !document.contains("features") || !document["features"].is_array())
    throw std::runtime_error("is no GeoJSON FeatureCollection");
  SemanticMap map;
  std::size_t number = 0;
  for (const json& feature : document["features"]) {
    ++number;
    try {
      add_feature(feature, map);
    } catch (const std::exception& error) {
      throw std::runtime_error("feature " + std::to_string(number) + ": " + error.what());
    }
  }
  return map;
}

SemanticMap transformed(const Pose2& T, SemanticMap map) {
  for (MapWall& wall : map.walls) wall.a = T * wall.a, wall.b = T * wall.b;
  for (MapDoor& door : map.doors) door.a = T * door.a, door.b = T * door.b;
  for (MapRoom& room : map.rooms) transform(T, room.polygon);
  for (MapObject& object : map.objects) transform(T, object.polygon);
  return map;
}

bool contains(const MapPolygon& polygon, const Eigen::Vector2d& point) {
  bool odd = inside(polygon.outline, point);
  for (const Ring& hole : polygon.holes) odd = odd != inside(hole, point);
  return odd;
}

}  // namespace modslam
