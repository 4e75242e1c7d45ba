// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/world.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/evaluation/semantic_map.hpp"
#include "common/formats/file_bytes.hpp"

namespace modslam {
namespace {

using nlohmann::json;
using Points = std::vector<Eigen::Vector2d>;

constexpr double kFarthest_m = 1e4;         // a building and its grounds
constexpr double kWidthTolerance_m = 0.01;  // a door's width is written to the centimetre

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument(why); }

std::string text_of(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// A value as an error quotes it: a short one as written, a nested one by its type alone.
std::string shown(const json& value) {
  const auto plain = [](const json& v) { return v.is_primitive(); };
  const bool short_list =
      value.is_array() && value.size() <= 3 && std::all_of(value.begin(), value.end(), plain);
  return value.is_primitive() || short_list ? value.dump() : value.type_name();
}

/// Reads the properties of one feature; every getter says which property is wrong and why.
class Properties {
 public:
  explicit Properties(const json& feature) : feature_(feature) {
    if (!feature.is_object() || !feature.contains("properties") ||
        !feature["properties"].is_object())
      refuse("has no properties");
    if (!feature.contains("geometry") || !feature["geometry"].is_object())
      refuse("has no geometry");
  }

  bool has(const char* name) const { return all().contains(name); }

  std::string word(const char* name) const {
    const json& value = get(name);
    if (!value.is_string() || value.get_ref<const std::string&>().empty())
      refuse(std::string(name) + " is " + shown(value) + ", expected a word");
    return value.get<std::string>();
  }

  /// True for `yes`, false for `no`.
  bool choice(const char* name, const std::string& yes, const std::string& no) const {
    const std::string value = word(name);
    if (value != yes && value != no)
      refuse(std::string(name) + " is \"" + value + "\", expected " + yes + " or " + no);
    return value == yes;
  }

  bool flag(const char* name) const {
    const json& value = get(name);
    if (!value.is_boolean())
      refuse(std::string(name) + " is " + shown(value) + ", expected true or false");
    return value.get<bool>();
  }

  double number(const char* name, double low, double high) const {
    const json& value = get(name);
    if (!value.is_number()) refuse(std::string(name) + " is " + shown(value) + ", no number");
    const double x = value.get<double>();
    if (!(x >= low && x <= high))
      refuse(std::string(name) + " is " + text_of(x) + ", outside [" + text_of(low) + ", " +
             text_of(high) + "]");
    return x;
  }

  const json& coordinates(const char* type) const {
    const json& geometry = feature_["geometry"];
    if (!geometry.contains("type") || geometry["type"] != type)
      refuse(std::string("geometry is no ") + type);
    if (!geometry.contains("coordinates") || !geometry["coordinates"].is_array())
      refuse("geometry has no coordinates");
    return geometry["coordinates"];
  }

 private:
  const json& all() const { return feature_["properties"]; }
  const json& get(const char* name) const {
    if (!has(name)) refuse(std::string("property ") + name + " is missing");
    return all()[name];
  }

  const json& feature_;
};

Eigen::Vector2d point_of(const json& pair) {
  if (!pair.is_array() || pair.size() < 2 || !pair[0].is_number() || !pair[1].is_number())
    refuse("point " + shown(pair) + " is no pair of finite numbers");
  const Eigen::Vector2d p(pair[0].get<double>(), pair[1].get<double>());
  if (!(p.cwiseAbs().maxCoeff() <= kFarthest_m))
    refuse("point " + shown(pair) + " is farther than " + text_of(kFarthest_m) + " m");
  return p;
}

/// At least two points, each other than the one before it.
Points line_of(const Properties& p) {
  Points line;
  for (const json& pair : p.coordinates("LineString")) {
    const Eigen::Vector2d next = point_of(pair);
    if (!line.empty() && line.back() == next) refuse("has point " + shown(pair) + " twice running");
    line.push_back(next);
  }
  if (line.size() < 2) refuse("has " + std::to_string(line.size()) + " points, expected 2 or more");
  return line;
}

Points segment_of(const Properties& p) {
  const Points line = line_of(p);
  if (line.size() != 2) refuse("has " + std::to_string(line.size()) + " points, expected 2");
  return line;
}

Points ring_of(const json& coordinates) {
  if (!coordinates.is_array()) refuse("ring " + shown(coordinates) + " is no list of points");
  Points ring;
  for (const json& pair : coordinates) ring.push_back(point_of(pair));
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3 || !(area_m2(MapPolygon{ring, {}}) > 0)) refuse("has a ring without area");
  return ring;
}

std::vector<Points> rings_of(const Properties& p) {
  std::vector<Points> rings;
  for (const json& ring : p.coordinates("Polygon")) rings.push_back(ring_of(ring));
  if (rings.empty()) refuse("has no ring");
  return rings;
}

WorldWall wall_of(const Properties& p) {
  const Points ends = segment_of(p);
  return {p.word("id"), ends[0], ends[1], p.number("thickness", 0.01, 2)};
}

WorldDoor door_of(const Properties& p) {
  const Points jambs = segment_of(p);
  const double width_m = (jambs[1] - jambs[0]).norm(), written_m = p.number("width", 0.1, 20);
  if (std::abs(written_m - width_m) > kWidthTolerance_m)
    refuse("width is " + text_of(written_m) + ", but its jambs are " + text_of(width_m) +
           " m apart");
  return {p.word("id"), jambs[0], jambs[1], width_m, p.choice("state", "open", "closed")};
}

WorldRoom room_of(const Properties& p) {
  std::vector<Points> rings = rings_of(p);
  WorldRoom room{p.word("id"), p.word("category"), p.word("name"), rings.front(), {}};
  room.holes.assign(rings.begin() + 1, rings.end());
  return room;
}

WorldObject object_of(const Properties& p) {
  const std::vector<Points> rings = rings_of(p);
  if (rings.size() > 1) refuse("is an object with a hole");
  return {p.word("id"), p.word("class"), rings.front()};
}

Route route_of(const Properties& p) {
  return {p.word("id"), line_of(p), p.number("speed", 0.01, 5), p.number("corner_radius", 0, 10),
          p.choice("turn", "in_place", "smooth")};
}

Person person_of(const Properties& p) {
  return {p.word("id"), line_of(p), p.number("radius", 0.05, 2), p.number("speed", 0.01, 5),
          p.flag("enabled")};
}

/// Sorts features into the world; remembers which ids are taken.
class Builder {
 public:
  explicit Builder(World& world) : world_(world) {}

  void add(const json& feature) {
    const Properties p(feature);
    const std::string kind = p.word("kind");
    if (p.has("id") && !ids_.insert(kind + " " + p.word("id")).second)
      refuse("is a second " + kind + " with id " + p.word("id"));
    if (kind == "wall") return world_.walls.push_back(wall_of(p));
    if (kind == "door") return world_.doors.push_back(door_of(p));
    if (kind == "room") return world_.rooms.push_back(room_of(p));
    if (kind == "object") return world_.objects.push_back(object_of(p));
    if (kind == "route") return world_.routes.push_back(route_of(p));
    if (kind == "person") return world_.persons.push_back(person_of(p));
    if (kind == "start") return set_start(p);
    refuse("kind is \"" + kind + "\", expected wall, door, room, object, route, person or start");
  }

  bool has_start() const { return has_start_; }

 private:
  void set_start(const Properties& p) {
    if (has_start_) refuse("is a second start");
    has_start_ = true;
    world_.start = point_of(p.coordinates("Point"));
    world_.start_heading = p.number("heading", -2 * kPi, 2 * kPi);
  }

  World& world_;
  std::set<std::string> ids_;
  bool has_start_ = false;
};

json features_of(const std::string& text) {
  json document = json::parse(text);
  if (!document.is_object() || !document.contains("features") || !document["features"].is_array())
    refuse("is no GeoJSON FeatureCollection");
  return std::move(document["features"]);
}

}  // namespace

World parse_world(const std::string& text, const std::string& name) {
  World world;
  world.name = name;
  Builder builder(world);
  std::string where = name + ": ";
  try {
    std::size_t number = 0;
    for (const json& feature : features_of(text)) {
      where = name + ": feature " + std::to_string(++number) + ": ";
      builder.add(feature);
    }
    where = name + ": ";
    if (!builder.has_start()) refuse("has no feature of kind start");
  } catch (const std::exception& error) {
    throw std::invalid_argument(where + error.what());
  }
  return world;
}

World load_world(const std::string& path) {
  const FileBytes file = read_file_bytes(path);
  if (!file.damage.empty()) throw std::runtime_error(path + ": " + file.damage);
  return parse_world(file.bytes, path);
}

const Route& route_of(const World& world, const std::string& id) {
  std::string known;
  for (const Route& route : world.routes) {
    if (route.id == id) return route;
    known += (known.empty() ? "" : ", ") + route.id;
  }
  throw std::invalid_argument(world.name + ": has no route \"" + id +
                              "\"; there are: " + (known.empty() ? "none" : known));
}

Route to_and_fro(Route route, std::int64_t laps) {
  const std::vector<Eigen::Vector2d> there = route.points;
  for (std::int64_t lap = 1; lap < laps; ++lap) {
    if (lap % 2 == 1)
      route.points.insert(route.points.end(), there.rbegin() + 1, there.rend());
    else
      route.points.insert(route.points.end(), there.begin() + 1, there.end());
  }
  return route;
}

}  // namespace modslam
