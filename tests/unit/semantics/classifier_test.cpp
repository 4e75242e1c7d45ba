// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/classifier.hpp"

#include <catch2/catch.hpp>

#include "common/evaluation/semantic_map.hpp"
#include "common/semantics/geojson.hpp"
#include "tests/support/ray_world.hpp"

using namespace modslam;

namespace {

/// Two rooms of 5 m x 4 m with walls 0.15 m thick between them and a door of 1 m in the middle, x
/// = 5.
test::RayWorld two_rooms() {
  test::RayWorld world;
  world.box(0, 0, 10.15, 4);
  world.box(5, 0, 5.15, 1.5);
  world.box(5, 2.5, 5.15, 4);
  return world;
}

void look(SemanticClassifier& classifier, test::RayWorld& world, double x, double y) {
  for (int i = 0; i < 4; ++i) {
    const Pose2 pose(x + 0.07 * i, y + 0.05 * i, 1.3 * i);
    classifier.insert(world.scan(pose), test::RayWorld::sensor(), pose);
  }
}

void look_around_both(SemanticClassifier& classifier, test::RayWorld& world) {
  for (const double x : {1.0, 2.5, 4.0, 6.0, 7.5, 9.0})
    for (const double y : {1.0, 2.0, 3.0}) look(classifier, world, x, y);
}

const Room* room_around(const Semantics& semantics, const Eigen::Vector2d& place) {
  for (const Room& room : semantics.rooms)
    if (contains(room.outline, place)) return &room;
  return nullptr;
}

}  // namespace

TEST_CASE("Two rooms with a door between are two rooms and one door that joins them",
          "[semantics]") {
  test::RayWorld world = two_rooms();
  SemanticClassifier classifier{SemanticsConfig()};
  look_around_both(classifier, world);
  const Semantics& s = classifier.render(1);
  REQUIRE(s.rooms.size() == 2);
  REQUIRE(s.doors.size() == 1);
  const Room *left = room_around(s, {2, 2}), *right = room_around(s, {8, 2});
  REQUIRE(left);
  REQUIRE(right);
  CHECK(left->area_m2 == Approx(20).margin(1));
  CHECK(right->area_m2 == Approx(20).margin(1));
  const Door& door = s.doors.front();
  CHECK(door.width_m() == Approx(1.0).margin(0.1));
  CHECK((door.segment.centre() - Eigen::Vector2d(5.075, 2)).norm() < 0.12);
  CHECK(std::minmax(door.room_a, door.room_b) == std::minmax(left->id, right->id));
}

TEST_CASE("Walls lie within a centimetre of the truth", "[semantics]") {
  test::RayWorld world = two_rooms();
  SemanticClassifier classifier{SemanticsConfig()};
  look_around_both(classifier, world);
  const Semantics& s = classifier.render(1);
  REQUIRE(s.walls.size() >= 8);
  for (const Wall& wall : s.walls) {
    for (const double t : {0.1, 0.5, 0.9}) {
      const Eigen::Vector2d p = wall.segment.a + t * (wall.segment.b - wall.segment.a);
      double nearest = 1e9;
      for (const Segment& truth : world.segments)
        nearest = std::min(nearest, distance_to_segment(p, truth));
      CHECK(nearest < 0.01);
    }
  }
}

TEST_CASE("Ids survive an update and new scans of the same place", "[semantics]") {
  test::RayWorld world = two_rooms();
  SemanticClassifier classifier{SemanticsConfig()};
  look_around_both(classifier, world);
  const Semantics first = classifier.render(1);
  look_around_both(classifier, world);
  const Semantics second = classifier.render(2);
  REQUIRE(first.rooms.size() == second.rooms.size());
  for (const Room& room : first.rooms) {
    Eigen::Vector2d middle(0, 0);
    for (const auto& p : room.outline) middle += p / static_cast<double>(room.outline.size());
    const Room* same = room_around(second, middle);
    REQUIRE(same);
    CHECK(same->id == room.id);
  }
  CHECK(first.doors.front().id == second.doors.front().id);
}

TEST_CASE("A space between walls that nobody has seen is no room", "[semantics]") {
  test::RayWorld world;
  world.box(0, 0, 16, 12);
  world.box(3, 3, 13, 9);  // closed block, seen from outside only
  SemanticClassifier classifier{SemanticsConfig()};
  for (const double x : {1.5, 4.5, 8.0, 11.5, 14.5})
    for (const double y : {1.5, 10.5}) look(classifier, world, x, y);
  for (const double x : {1.5, 14.5}) look(classifier, world, x, 6);
  const Semantics& s = classifier.render(1);
  CHECK(s.rooms.size() == 4);  // the four strips around it
  CHECK(room_around(s, {8, 6}) == nullptr);
}

TEST_CASE("A car in a garage is an object, neither walls nor room", "[semantics]") {
  test::RayWorld world;
  world.box(0, 0, 12, 10);
  world.box(5, 3, 6.8, 7.4);
  SemanticClassifier classifier{SemanticsConfig()};
  for (const auto& [x, y] : {std::pair{2.0, 1.5},
                             {6.0, 1.5},
                             {10.0, 1.5},
                             {10.0, 5.0},
                             {10.0, 8.5},
                             {6.0, 8.5},
                             {2.0, 8.5},
                             {2.0, 5.0}})
    look(classifier, world, x, y);
  const Semantics& s = classifier.render(1);
  REQUIRE(s.rooms.size() == 1);
  CHECK(s.rooms.front().area_m2 == Approx(120).margin(3));
  for (const Wall& wall : s.walls) CHECK(wall.segment.length_m() > 9);
  REQUIRE(s.objects.size() == 1);
  CHECK(s.objects.front().class_name == "car");
  CHECK(s.objects.front().area_m2 == Approx(7.9).margin(0.6));
}

TEST_CASE("After the graph moved the map, redrawn scans give the map of the new poses",
          "[semantics]") {
  test::RayWorld world = two_rooms(), twin_world = two_rooms();
  SemanticClassifier moved{SemanticsConfig()}, twin{SemanticsConfig()};
  const Pose2 shift(0.37, -0.21, 0.05);
  std::size_t id = 0;
  for (const double x : {1.0, 2.5, 4.0, 6.0, 7.5, 9.0}) {
    const Pose2 pose(x, 2, x);
    const Scan scan = world.scan(pose);
    moved.insert(scan, test::RayWorld::sensor(), pose);
    moved.set_pose(id++, shift * pose);
    twin.insert(scan, test::RayWorld::sensor(), shift * pose);
  }
  CHECK(moved.redraw(false) == 6);
  CHECK(moved.redraw(true) == 0);
  CHECK(semantic_geojson(moved.render(1)) == semantic_geojson(twin.render(1)));
}

TEST_CASE("Nothing seen gives an empty map, and its GeoJSON can be read", "[semantics]") {
  SemanticClassifier classifier{SemanticsConfig()};
  const Semantics& s = classifier.render(0);
  CHECK(s.walls.empty());
  CHECK(s.rooms.empty());
  CHECK(parse_semantic_map(semantic_geojson(s)).walls.empty());
}

TEST_CASE("The GeoJSON is what the scorer reads", "[semantics]") {
  test::RayWorld world = two_rooms();
  SemanticClassifier classifier{SemanticsConfig()};
  look_around_both(classifier, world);
  const Semantics& s = classifier.render(1);
  const SemanticMap map = parse_semantic_map(semantic_geojson(s));
  CHECK(map.walls.size() == s.walls.size());
  CHECK(map.rooms.size() == 2);
  REQUIRE(map.doors.size() == 1);
  CHECK(map.doors.front().rooms_known);
}
