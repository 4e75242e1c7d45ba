// SPDX-License-Identifier: BSD-3-Clause
/// The whole way from scans to walls, doors, rooms and objects.
#include "common/semantics/semantic_mapper.hpp"

#include <catch2/catch.hpp>

#include "common/semantics/room_finder.hpp"
#include "tests/support/two_rooms.hpp"

using namespace modslam;

namespace {

constexpr std::uint64_t kSeed = 704;

/// A mapper fed with what is seen from each place, all of them shifted by `T_map_world`.
SemanticMapper mapper_after(const test::Plan& plan, const std::vector<Pose2>& places, const Pose2& T_map_world = {}) {
  const SensorInfo sensor = test::short_laser();
  RandomStream random(kSeed, RandomStreamId::kLaser);
  SemanticMapper mapper{SemanticsConfig()};
  for (const Pose2& T_world_base : places) mapper.add_node(test::see(plan, sensor, T_world_base, &random), sensor, T_map_world * T_world_base);
  return mapper;
}

template <class Thing>
std::vector<std::int64_t> ids(const std::vector<Thing>& things) {
  std::vector<std::int64_t> out;
  for (const Thing& thing : things) out.push_back(thing.id);
  std::sort(out.begin(), out.end());
  return out;
}

bool same_outline(const std::vector<Eigen::Vector2d>& p, const std::vector<Eigen::Vector2d>& q) {
  return p.size() == q.size() && std::equal(p.begin(), p.end(), q.begin());
}

}  // namespace

TEST_CASE("a drive through two rooms finds two rooms, the door between them and the walls around") {
  SemanticMapper mapper = mapper_after(test::two_rooms(), test::drive_through_two_rooms());
  const SemanticLayers layers = mapper.update(true);
  REQUIRE(layers.rooms.size() == 2);
  REQUIRE(layers.doors.size() == 1);
  const Door& door = layers.doors[0];
  REQUIRE((door.centre() - Eigen::Vector2d(0, 0)).norm() < 0.12);
  REQUIRE(door.width_m() == Approx(0.9).margin(0.12));
  REQUIRE(door.room_a != 0);
  REQUIRE(door.room_b != 0);
  REQUIRE(door.room_a != door.room_b);
  for (const Room& room : layers.rooms) REQUIRE(room.area_m2 == Approx(3.92 * 6).margin(19.8 * 0.085));
  for (const Wall& wall : layers.walls) REQUIRE(wall.evidence > 0);
  REQUIRE(layers.objects.empty());
}

TEST_CASE("ids of walls, rooms and doors outlast an update, more scans and a small move of everything") {
  const auto places = test::drive_through_two_rooms();
  SemanticMapper mapper = mapper_after(test::two_rooms(), places);
  const SemanticLayers first = mapper.update(false);
  REQUIRE_FALSE(first.walls.empty());
  const SemanticLayers again = mapper.update(false);
  const Pose2 T_new_old(0.10, -0.06, 0.012);
  for (std::size_t k = 0; k < places.size(); ++k) mapper.set_pose(static_cast<NodeId>(k), T_new_old * places[k]);
  const SemanticLayers moved = mapper.update(true);
  for (const SemanticLayers* later : {&again, &moved}) {
    REQUIRE(ids(later->walls) == ids(first.walls));
    REQUIRE(ids(later->doors) == ids(first.doors));
    REQUIRE(ids(later->rooms) == ids(first.rooms));
  }
  for (const Room& before : first.rooms)
    for (const Room& after : moved.rooms) {
      REQUIRE((before.id == after.id) == (contains(before.outline, {-2, 0}) == contains(after.outline, {-2, 0})));
      if (before.id == after.id) REQUIRE(before.name == after.name);
    }
}

TEST_CASE("after all nodes moved the map is, to the bit, the one of a mapper that knew the places from the start") {
  const auto places = test::drive_through_two_rooms();
  const Pose2 T_map_world(0.7, -0.4, 0.3);
  SemanticMapper moved = mapper_after(test::two_rooms(), places), fresh = mapper_after(test::two_rooms(), places, T_map_world);
  moved.update(false);
  for (std::size_t k = 0; k < places.size(); ++k) moved.set_pose(static_cast<NodeId>(k), T_map_world * places[k]);
  const SemanticLayers a = moved.update(true), b = fresh.update(true);
  REQUIRE(a.walls.size() == b.walls.size());
  REQUIRE(a.doors.size() == b.doors.size());
  REQUIRE(a.rooms.size() == b.rooms.size());
  for (std::size_t k = 0; k < a.walls.size(); ++k) {
    REQUIRE(a.walls[k].a == b.walls[k].a);
    REQUIRE(a.walls[k].b == b.walls[k].b);
    REQUIRE(a.walls[k].evidence == b.walls[k].evidence);
  }
  for (std::size_t k = 0; k < a.rooms.size(); ++k) REQUIRE(same_outline(a.rooms[k].outline, b.rooms[k].outline));
}

TEST_CASE("a car in a hall is an object: no room, and its faces are no walls") {
  test::Plan hall;
  test::add_box(hall, -6, -5, 6, 5);
  test::add_box(hall, -2.2, -0.9, 2.2, 0.9);
  std::vector<Pose2> places;
  for (int k = 0; k < 40; ++k) {
    const double angle = 2 * kPi * k / 40;
    places.push_back({4.0 * std::cos(angle), 3.0 * std::sin(angle), angle + kPi / 2});
  }
  SemanticMapper mapper = mapper_after(hall, places);
  const SemanticLayers layers = mapper.update(true);
  REQUIRE(layers.objects.size() == 1);
  REQUIRE(layers.objects[0].class_name == "car");
  REQUIRE(layers.rooms.size() == 1);
  REQUIRE(layers.rooms[0].area_m2 > 100);
  for (const Wall& wall : layers.walls) REQUIRE(std::max(std::abs(wall.a.x()) / 6, std::abs(wall.a.y()) / 5) > 0.95);
  REQUIRE(layers.doors.empty());
}

TEST_CASE("a piece of wall between two doors with a shelf against it is a wall, no object") {
  test::Plan plan;
  test::add_box(plan, -4, -4, 4, 4);
  for (const double x : {-0.08, 0.08})
    for (const auto& [low, high] : {std::pair(-4.0, -2.4), std::pair(-1.5, 1.5), std::pair(2.4, 4.0)}) {
      plan.push_back({{x, low}, {x, high}});
      for (const double y : {low, high}) plan.push_back({{-0.08, y}, {0.08, y}});
    }
  test::add_box(plan, 0.08, -1.0, 0.68, 1.0);
  std::vector<Pose2> places;
  for (int k = 0; k < 60; ++k) {
    const double angle = 2 * kPi * k / 60;
    places.push_back({2.2 * std::cos(angle), 2.0 * std::sin(angle), angle + kPi / 2});
    if (std::abs(places.back().x) < 0.8) places.back().y = places.back().y > 0 ? 1.95 : -1.95;
  }
  SemanticMapper mapper = mapper_after(plan, places);
  const SemanticLayers layers = mapper.update(true);
  REQUIRE(layers.objects.empty());
  REQUIRE(layers.doors.size() == 2);
  REQUIRE(layers.rooms.size() == 2);
  REQUIRE(std::any_of(layers.walls.begin(), layers.walls.end(), [](const Wall& w) {
    return std::abs(w.a.x() + 0.08) < 0.05 && std::abs(w.b.x() + 0.08) < 0.05 && w.length_m() > 2.5;
  }));
}

TEST_CASE("clear() forgets everything, and nothing is found in nothing") {
  SemanticMapper mapper = mapper_after(test::two_rooms(), test::drive_through_two_rooms());
  mapper.update(false);
  mapper.clear();
  const SemanticLayers layers = mapper.update(true);
  REQUIRE(layers.walls.empty());
  REQUIRE(layers.rooms.empty());
  REQUIRE(layers.doors.empty());
  REQUIRE(layers.objects.empty());
  const SensorInfo sensor = test::short_laser();
  Scan blind = test::see({}, sensor, {});
  mapper.add_node(blind, sensor, {});
  REQUIRE(mapper.update(true).walls.empty());
}
