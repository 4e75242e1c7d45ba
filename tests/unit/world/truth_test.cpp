// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/truth.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/evaluation/semantic_map.hpp"

using namespace modslam;
using nlohmann::json;

namespace {

std::vector<Eigen::Vector2d> box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// A room south and a ring corridor north of the wall y = 0, a door between and one to the outside.
World toy_world() {
  World world;
  world.walls = {{"w1", {0, 0}, {1, 0}, 0.15}, {"w2", {2, 0}, {6, 0}, 0.15}};
  world.doors = {{"d1", {1, 0}, {2, 0}, 1, true}, {"d2", {0, -3}, {0, -2}, 1, false}};
  world.rooms = {{"south", "office", "Office", box(0.075, -4, 6, -0.075), {}},
                 {"ring", "corridor", "Ring", box(0, 0.075, 6, 6), {box(2, 2, 4, 4)}}};
  world.objects = {{"o1", "desk", box(3, -2, 4, -1.5)}};
  world.routes = {{"r", {{1, -1}, {1, 1}}, 0.5, 0, false}};
  return world;
}

json features_of(const World& world, const std::string& kind) {
  json found = json::array();
  const json all = json::parse(world_truth_geojson(world));  // named: a range-for keeps no temporary alive
  for (const json& f : all.at("features"))
    if (f.at("properties").at("kind") == kind) found.push_back(f);
  return found;
}

}  // namespace

TEST_CASE("The truth names what stands in the world, with lengths and areas") {
  const World world = toy_world();
  const json walls = features_of(world, "wall");
  REQUIRE(walls.size() == 2);
  CHECK(walls[1]["properties"]["length_m"] == 4);
  CHECK(walls[1]["properties"]["thickness_m"] == 0.15);
  CHECK(walls[1]["geometry"]["coordinates"] == json::parse("[[2,0],[6,0]]"));

  const json rooms = features_of(world, "room");
  REQUIRE(rooms.size() == 2);
  CHECK(rooms[0]["properties"]["type"] == "room");
  CHECK(rooms[1]["properties"]["type"] == "corridor");
  CHECK(rooms[1]["properties"]["name"] == "Ring");
  CHECK(rooms[1]["properties"]["area_m2"].get<double>() == Approx(6 * 5.925 - 4).margin(1e-3));
  CHECK(rooms[1]["geometry"]["coordinates"].size() == 2);

  const json objects = features_of(world, "object");
  REQUIRE(objects.size() == 1);
  CHECK(objects[0]["properties"]["class"] == "desk");
  CHECK(objects[0]["properties"]["area_m2"] == 0.5);
  CHECK(features_of(world, "route").empty());
}

TEST_CASE("A door knows the rooms on its left and right, and the outside") {
  const World world = toy_world();
  CHECK(rooms_joined(world, world.doors[0]) == std::array<std::string, 2>{"ring", "south"});
  CHECK(rooms_joined(world, world.doors[1]) == std::array<std::string, 2>{"", "south"});
  const json doors = features_of(world, "door");
  REQUIRE(doors.size() == 2);
  CHECK(doors[0]["properties"]["rooms"] == json::parse(R"(["ring", "south"])"));
  CHECK(doors[1]["properties"]["rooms"] == json::parse(R"([null, "south"])"));
  CHECK(doors[1]["properties"]["state"] == "closed");
  CHECK(doors[1]["properties"]["width_m"] == 1);
}

TEST_CASE("The scorer reads the truth as it was drawn") {
  const SemanticMap map = parse_semantic_map(world_truth_geojson(toy_world()));
  REQUIRE(map.walls.size() == 2);
  CHECK(map.walls[0].thickness_m == 0.15);
  CHECK(map.rooms.size() == 2);
  REQUIRE(map.doors.size() == 2);
  CHECK(map.doors[1].closed);
  CHECK(map.doors[1].rooms_known);
  CHECK(map.doors[1].room_a.empty());
  CHECK(map.objects.size() == 1);
}

TEST_CASE("An empty world has an empty truth that is still GeoJSON") {
  CHECK(json::parse(world_truth_geojson(World())).at("features").empty());
}
