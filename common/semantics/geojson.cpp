// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/geojson.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace modslam {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value) { return std::round(value * 1000) / 1000; }

Json place(const Eigen::Vector2d& p) { return {rounded(p.x()), rounded(p.y())}; }

Json line(const Segment& s) {
  return {{"type", "LineString"}, {"coordinates", {place(s.a), place(s.b)}}};
}

Json polygon(const Polygon& outline) {
  Json ring = Json::array();
  for (const Eigen::Vector2d& p : outline) ring.push_back(place(p));
  if (!outline.empty()) ring.push_back(place(outline.front()));
  return {{"type", "Polygon"}, {"coordinates", Json::array({ring})}};
}

Json feature(Json properties, Json geometry) {
  return {{"type", "Feature"},
          {"properties", std::move(properties)},
          {"geometry", std::move(geometry)}};
}

std::string name(const char* kind, std::int64_t id) { return kind + std::to_string(id); }

Json room_name(std::int64_t id) { return id ? Json(name("room", id)) : Json(nullptr); }

}  // namespace

std::string semantic_geojson(const Semantics& semantics) {
  Json features = Json::array();
  for (const Wall& wall : semantics.walls)
    features.push_back(feature({{"kind", "wall"},
                                {"id", name("wall", wall.id)},
                                {"length_m", rounded(wall.segment.length_m())},
                                {"evidence", rounded(wall.evidence)}},
                               line(wall.segment)));
  for (const Room& room : semantics.rooms)
    features.push_back(feature({{"kind", "room"},
                                {"id", name("room", room.id)},
                                {"type", room.type == RoomType::kCorridor ? "corridor" : "room"},
                                {"area_m2", rounded(room.area_m2)},
                                {"explored", rounded(room.explored)},
                                {"name", room.name}},
                               polygon(room.outline)));
  for (const Door& door : semantics.doors)
    features.push_back(feature({{"kind", "door"},
                                {"id", name("door", door.id)},
                                {"width_m", rounded(door.width_m())},
                                {"rooms", {room_name(door.room_a), room_name(door.room_b)}},
                                {"state", "open"},
                                {"evidence", rounded(door.evidence)}},
                               line(door.segment)));
  for (const Object& object : semantics.objects)
    features.push_back(feature({{"kind", "object"},
                                {"id", name("object", object.id)},
                                {"class", object.class_name},
                                {"area_m2", rounded(object.area_m2)}},
                               polygon(object.outline)));
  return Json{{"type", "FeatureCollection"}, {"features", features}}.dump(1) + "\n";
}

}  // namespace modslam
