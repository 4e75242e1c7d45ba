// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/world.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <random>
#include <sstream>

using namespace modslam;
using Catch::Matchers::Contains;

namespace {

const std::string kStart =
    R"({"properties":{"kind":"start","heading":1.5},"geometry":{"type":"Point","coordinates":[1,2]}})";
const std::string kWall = R"({"properties":{"kind":"wall","id":"w","thickness":0.15},
    "geometry":{"type":"LineString","coordinates":[[0,0],[4,0]]}})";

std::string collection(const std::string& features) {
  return R"({"type":"FeatureCollection","features":[)" + features + "]}";
}

World world_with(const std::string& feature) {
  return parse_world(collection(kStart + "," + feature), "toy");
}

std::string feature(const std::string& properties, const std::string& type,
                    const std::string& coordinates) {
  return R"({"properties":{)" + properties + R"(},"geometry":{"type":")" + type +
         R"(","coordinates":)" + coordinates + "}}";
}

/// What is said about the second feature of a world that has a good start as its first.
std::string complaint(const std::string& feature) {
  try {
    world_with(feature);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("Every kind of feature arrives in the world with its numbers") {
  const World world = parse_world(
      collection(
          kStart + "," + kWall + "," +
          feature(R"("kind":"door","id":"d","width":1,"state":"closed")", "LineString",
                  "[[4,0],[5,0]]") +
          "," +
          feature(R"("kind":"room","id":"r","category":"corridor","name":"Ring")", "Polygon",
                  "[[[0,0],[9,0],[9,9],[0,9],[0,0]],[[3,3],[3,6],[6,6],[6,3],[3,3]]]") +
          "," +
          feature(R"("kind":"object","id":"o","class":"car")", "Polygon",
                  "[[[1,1],[2,1],[2,2],[1,1]]]") +
          "," +
          feature(R"("kind":"route","id":"t","speed":0.5,"corner_radius":0.8,"turn":"in_place")",
                  "LineString", "[[1,1],[1,2],[1,1]]") +
          "," +
          feature(R"("kind":"person","id":"p","radius":0.25,"speed":1,"enabled":true)",
                  "LineString", "[[1,1],[1,2]]")),
      "toy");

  CHECK(world.name == "toy");
  CHECK(world.start == Eigen::Vector2d(1, 2));
  CHECK(world.start_heading == 1.5);
  REQUIRE(world.walls.size() == 1);
  CHECK(world.walls[0].b == Eigen::Vector2d(4, 0));
  CHECK(world.walls[0].thickness_m == 0.15);
  REQUIRE(world.doors.size() == 1);
  CHECK_FALSE(world.doors[0].open);
  CHECK(world.doors[0].width_m == 1);
  REQUIRE(world.rooms.size() == 1);
  CHECK(world.rooms[0].polygon.size() == 4);  // the ring is opened
  CHECK(world.rooms[0].holes.size() == 1);
  REQUIRE(world.objects.size() == 1);
  CHECK(world.objects[0].class_name == "car");
  CHECK(world.objects[0].polygon.size() == 3);
  const Route& route = route_of(world, "t");
  CHECK(route.points.size() == 3);
  CHECK(route.speed_mps == 0.5);
  CHECK(route.corner_radius_m == 0.8);
  CHECK(route.turn_in_place);
  REQUIRE(world.persons.size() == 1);
  CHECK(world.persons[0].radius_m == 0.25);
  CHECK(world.persons[0].enabled);
}

TEST_CASE("A feature that is wrong is refused by file, number and reason") {
  CHECK(complaint(kWall) == "nothing");
  const auto wall = [](const std::string& more, const std::string& line) {
    return feature(R"("kind":"wall")" + more, "LineString", line);
  };
  const std::string good = R"(,"id":"w","thickness":0.15)", line = "[[0,0],[1,0]]";

  CHECK_THAT(complaint(wall(R"(,"id":"w")", line)),
             Contains("toy: feature 2: property thickness is missing"));
  CHECK_THAT(complaint(wall(R"(,"id":"w","thickness":"thin")", line)), Contains("no number"));
  CHECK_THAT(complaint(wall(R"(,"id":"w","thickness":-1)", line)),
             Contains("thickness is -1, outside [0.01, 2]"));
  CHECK_THAT(complaint(wall(good, "[[0,0]]")), Contains("has 1 points"));
  CHECK_THAT(complaint(wall(good, "[[0,0],[0,0]]")), Contains("twice running"));
  CHECK_THAT(complaint(wall(good, "[[0,0],[1,0],[1,1]]")), Contains("expected 2"));
  CHECK_THAT(complaint(wall(good, "[[0,0],[null,0]]")), Contains("no pair of finite numbers"));
  CHECK_THAT(complaint(wall(good, "[[0,0],[1e300,0]]")), Contains("farther than"));
  CHECK_THAT(complaint(wall(good, "[[0,0],7]")), Contains("no pair of finite numbers"));
  CHECK_THAT(complaint(feature(R"("kind":"wall","id":"w","thickness":1)", "Point", "[0,0]")),
             Contains("is no LineString"));
  CHECK_THAT(complaint(feature(R"("kind":"volcano","id":"v")", "Point", "[0,0]")),
             Contains("feature 2: kind is \"volcano\""));
  CHECK_THAT(complaint("7"), Contains("feature 2: has no properties"));
  CHECK_THAT(complaint(R"({"properties":{"kind":"wall"},"geometry":null})"),
             Contains("has no geometry"));
  CHECK_THAT(complaint(kStart), Contains("second start"));
  CHECK_THAT(complaint(kWall + "," + kWall), Contains("feature 3: is a second wall with id w"));
}

TEST_CASE("Doors, polygons and people are held to their meaning") {
  CHECK_THAT(complaint(feature(R"("kind":"door","id":"d","width":1,"state":"open")", "LineString",
                               "[[0,0],[1.2,0]]")),
             Contains("width is 1, but its jambs are 1.2 m apart"));
  CHECK_THAT(complaint(feature(R"("kind":"door","id":"d","width":1,"state":"ajar")", "LineString",
                               "[[0,0],[1,0]]")),
             Contains("expected open or closed"));
  const std::string car = R"("kind":"object","id":"o","class":"car")";
  CHECK_THAT(complaint(feature(car, "Polygon", "[[[0,0],[1,1],[2,2],[0,0]]]")),
             Contains("ring without area"));
  CHECK_THAT(complaint(feature(car, "Polygon", "[[]]")), Contains("ring without area"));
  CHECK_THAT(complaint(feature(car, "Polygon", "[]")), Contains("has no ring"));
  CHECK_THAT(complaint(feature(R"("kind":"person","id":"p","radius":0.2,"speed":1,"enabled":1)",
                               "LineString", "[[0,0],[1,0]]")),
             Contains("expected true or false"));
}

TEST_CASE("A file that is no world says so") {
  CHECK_THROWS_WITH(parse_world("{\"features\": [", "cut"), Contains("cut: ") && Contains("parse"));
  CHECK_THROWS_WITH(parse_world("", "empty"), Contains("empty: "));
  CHECK_THROWS_WITH(parse_world("[1, 2]", "list"), Contains("list: is no GeoJSON"));
  CHECK_THROWS_WITH(parse_world(collection(kWall), "toy"), Contains("no feature of kind start"));
  CHECK_THROWS_WITH(parse_world(collection("{\"a\": 1e999}"), "toy"), Contains("toy: "));
  CHECK_THROWS_WITH(load_world("/nowhere/world.geojson"), Contains("/nowhere/world.geojson"));
}

TEST_CASE("A route that is not there is answered with those that are") {
  const World world = world_with(
      feature(R"("kind":"route","id":"tour","speed":1,"corner_radius":0,"turn":"smooth")",
              "LineString", "[[0,0],[1,0]]"));
  CHECK_THROWS_WITH(route_of(world, "trip"), Contains("no route \"trip\"; there are: tour"));
  CHECK_THROWS_WITH(route_of(World(), "trip"), Contains("there are: none"));
}

TEST_CASE("A shipped world with bytes changed is read or refused, never worse") {
  std::ifstream file(MODSLAM_SOURCE_DIR "/config/worlds/apartment.geojson");
  std::stringstream content;
  content << file.rdbuf();
  const std::string good = content.str();
  REQUIRE(good.size() > 10000);
  std::mt19937_64 random(20240517);
  const std::string letters = "[]{},:\"0123456789.-eE \nnulltrue";
  int read = 0, refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string text = good;
    for (int k = 0; k < 1 + i % 3; ++k)
      text[random() % text.size()] = letters[random() % letters.size()];
    if (i % 10 == 0) text.resize(random() % text.size());
    try {
      parse_world(text, "mutant");
      ++read;
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  CHECK(read > 20);
  CHECK(refused > 100);
}

TEST_CASE("Brackets nested a million deep are refused in few words") {
  const int depth = 1000000;
  const std::string deep = std::string(depth, '[') + std::string(depth, ']');
  const std::string words = complaint(
      feature(R"("kind":"wall","id":"w","thickness":0.15)", "LineString", "[[0,0]," + deep + "]"));
  CHECK_THAT(words, Contains("feature 2: point array is no pair"));
  CHECK(words.size() < 200);
}
