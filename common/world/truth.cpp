// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/truth.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/evaluation/semantic_map.hpp"

namespace modslam {
namespace {

using json = nlohmann::ordered_json;
using Points = std::vector<Eigen::Vector2d>;

constexpr double kProbeStep_m = 0.1, kProbeReach_m = 0.5;  // past any wall, short of the next room

/// Millimetres are what a world is drawn in; more digits would be rounding noise.
double to_mm(double metres) { return std::round(metres * 1000) / 1000; }

json point_json(const Eigen::Vector2d& p) { return {to_mm(p.x()), to_mm(p.y())}; }

json line_json(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return {{"type", "LineString"}, {"coordinates", json::array({point_json(a), point_json(b)})}};
}

json ring_json(const Points& ring) {
  json closed = json::array();
  for (const Eigen::Vector2d& p : ring) closed.push_back(point_json(p));
  closed.push_back(point_json(ring.front()));
  return closed;
}

json polygon_json(const MapPolygon& polygon) {
  json rings = json::array({ring_json(polygon.outline)});
  for (const Points& hole : polygon.holes) rings.push_back(ring_json(hole));
  return {{"type", "Polygon"}, {"coordinates", rings}};
}

json feature(json properties, json geometry) {
  return {{"type", "Feature"},
          {"properties", std::move(properties)},
          {"geometry", std::move(geometry)}};
}

json wall_json(const WorldWall& wall) {
  return feature({{"kind", "wall"},
                  {"id", wall.id},
                  {"length_m", to_mm((wall.b - wall.a).norm())},
                  {"thickness_m", wall.thickness_m}},
                 line_json(wall.a, wall.b));
}

MapPolygon polygon_of(const WorldRoom& room) { return {room.polygon, room.holes}; }

json room_json(const WorldRoom& room) {
  const MapPolygon polygon = polygon_of(room);
  return feature({{"kind", "room"},
                  {"id", room.id},
                  {"type", room.category == "corridor" ? "corridor" : "room"},
                  {"area_m2", to_mm(area_m2(polygon))},
                  {"name", room.name}},
                 polygon_json(polygon));
}

json door_json(const World& world, const WorldDoor& door) {
  json rooms = json::array();
  for (const std::string& id : rooms_joined(world, door))
    rooms.push_back(id.empty() ? json() : json(id));
  return feature({{"kind", "door"},
                  {"id", door.id},
                  {"width_m", to_mm(door.width_m)},
                  {"rooms", rooms},
                  {"state", door.open ? "open" : "closed"}},
                 line_json(door.a, door.b));
}

json object_json(const WorldObject& object) {
  const MapPolygon polygon{object.polygon, {}};
  return feature({{"kind", "object"},
                  {"id", object.id},
                  {"class", object.class_name},
                  {"area_m2", to_mm(area_m2(polygon))}},
                 polygon_json(polygon));
}

std::string room_at(const World& world, const Eigen::Vector2d& point) {
  for (const WorldRoom& room : world.rooms)
    if (contains(polygon_of(room), point)) return room.id;
  return "";
}

/// The first room met from the door's middle along `direction` (unit length).
std::string room_towards(const World& world, const WorldDoor& door, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d middle = 0.5 * (door.a + door.b);
  const int steps = static_cast<int>(std::lround(kProbeReach_m / kProbeStep_m));
  for (int i = 1; i <= steps; ++i) {
    const std::string id = room_at(world, middle + i * kProbeStep_m * direction);
    if (!id.empty()) return id;
  }
  return "";
}

}  // namespace

std::array<std::string, 2> rooms_joined(const World& world, const WorldDoor& door) {
  const Eigen::Vector2d along = (door.b - door.a).normalized();
  const Eigen::Vector2d left(-along.y(), along.x());
  return {room_towards(world, door, left), room_towards(world, door, -left)};
}

std::string world_truth_geojson(const World& world) {
  std::vector<json> features;
  for (const WorldWall& wall : world.walls) features.push_back(wall_json(wall));
  for (const WorldRoom& room : world.rooms) features.push_back(room_json(room));
  for (const WorldDoor& door : world.doors) features.push_back(door_json(world, door));
  for (const WorldObject& object : world.objects) features.push_back(object_json(object));

  std::string text = "{\"type\": \"FeatureCollection\", \"features\": [";
  for (std::size_t i = 0; i < features.size(); ++i) text += (i ? ",\n" : "\n") + features[i].dump();
  return text + "\n]}\n";
}

}  // namespace modslam
