// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/layers_reader.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace modslam {
namespace {

using Json = nlohmann::json;
using Ring = std::vector<Eigen::Vector2d>;

constexpr double kFarthest_m = 1e6;

Eigen::Vector2d point_of(const Json& pair) {
  const Eigen::Vector2d p(pair.at(0).get<double>(), pair.at(1).get<double>());
  if (!(p.cwiseAbs().maxCoeff() < kFarthest_m)) throw std::runtime_error("a point is not within 1e6 m");
  return p;
}

void read_line(const Json& geometry, Eigen::Vector2d& a, Eigen::Vector2d& b) {
  const Json& line = geometry.at("coordinates");
  if (geometry.at("type") != "LineString" || line.size() != 2) throw std::runtime_error("is no LineString of two points");
  a = point_of(line.at(0));
  b = point_of(line.at(1));
}

Ring ring_of(const Json& geometry) {
  if (geometry.at("type") != "Polygon") throw std::runtime_error("is no Polygon");
  Ring ring;
  for (const Json& corner : geometry.at("coordinates").at(0)) ring.push_back(point_of(corner));
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3) throw std::runtime_error("has fewer than three corners");
  return ring;
}

std::string short_name(const Json& properties, const char* key) { return properties.value(key, "").substr(0, 200); }

WallEnd end_of(const Json& properties, std::size_t k) {
  const Json ends = properties.value("ends", Json::array());
  if (ends.size() != 2) return {};
  return {ends[k].value("across_m", 0.0), ends[k].value("along_m", 0.0), ends[k].value("seen", false)};
}

Wall wall_of(const Json& properties, const Json& geometry) {
  Wall wall;
  wall.id = properties.value("id", std::int64_t{0});
  wall.evidence = properties.value("evidence", 0.0);
  wall.sigma_m = properties.value("sigma_m", 0.0);
  wall.at_a = end_of(properties, 0);
  wall.at_b = end_of(properties, 1);
  read_line(geometry, wall.a, wall.b);
  return wall;
}

Door door_of(const Json& properties, const Json& geometry) {
  Door door;
  door.id = properties.value("id", std::int64_t{0});
  door.evidence = properties.value("evidence", 0.0);
  door.closed = properties.value("state", "") == "closed";
  const Json rooms = properties.value("rooms", Json::array());
  if (rooms.size() == 2) {
    door.room_a = rooms[0].get<std::int64_t>();
    door.room_b = rooms[1].get<std::int64_t>();
  }
  read_line(geometry, door.a, door.b);
  return door;
}

Room room_of(const Json& properties, const Json& geometry) {
  Room room;
  room.id = properties.value("id", std::int64_t{0});
  room.name = short_name(properties, "name");
  room.corridor = properties.value("type", "") == "corridor";
  room.area_m2 = properties.value("area_m2", 0.0);
  room.explored = properties.value("explored", 0.0);
  room.outline = ring_of(geometry);
  return room;
}

Object object_of(const Json& properties, const Json& geometry) {
  Object object;
  object.id = properties.value("id", std::int64_t{0});
  object.class_name = short_name(properties, "class");
  object.class_confidence = properties.value("class_confidence", 0.0);
  object.area_m2 = properties.value("area_m2", 0.0);
  object.outline = ring_of(geometry);
  return object;
}

Place place_of(const Json& properties, const Json& geometry) {
  Place place;
  place.node = properties.value("id", std::int64_t{0});
  const std::string kind = properties.value("class", "");
  for (const PlaceKind known : {PlaceKind::kRoom, PlaceKind::kCorridor, PlaceKind::kDoorway})
    if (kind == place_name(known)) place.kind = known;
  if (kind != place_name(place.kind)) throw std::runtime_error("is a place of no known class");
  place.confidence = properties.value("confidence", 0.0);
  if (geometry.at("type") != "Point") throw std::runtime_error("is no Point");
  place.p = point_of(geometry.at("coordinates"));
  return place;
}

void add(const Json& feature, SemanticLayers& layers) {
  const Json &properties = feature.at("properties"), &geometry = feature.at("geometry");
  const std::string kind = properties.is_object() ? properties.value("kind", "") : "";
  if (kind == "wall") layers.walls.push_back(wall_of(properties, geometry));
  if (kind == "door") layers.doors.push_back(door_of(properties, geometry));
  if (kind == "room") layers.rooms.push_back(room_of(properties, geometry));
  if (kind == "object") layers.objects.push_back(object_of(properties, geometry));
  if (kind == "place") layers.places.push_back(place_of(properties, geometry));
}

}  // namespace

SemanticLayers parse_layers(const std::string& geojson) {
  const Json document = Json::parse(geojson, nullptr, false);
  if (document.is_discarded()) throw std::runtime_error("is not JSON");
  if (!document.is_object() || !document.contains("features") || !document["features"].is_array())
    throw std::runtime_error("is no GeoJSON FeatureCollection");
  SemanticLayers layers;
  std::size_t number = 0;
  for (const Json& feature : document["features"]) {
    ++number;
    try {
      add(feature, layers);
    } catch (const std::exception& error) {
      throw std::runtime_error("feature " + std::to_string(number) + ": " + error.what());
    }
  }
  return layers;
}

}  // namespace modslam
