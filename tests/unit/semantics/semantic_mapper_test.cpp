// SPDX-License-Identifier: BSD-3-Clause
/// The whole way from scans to walls, doors, rooms and objects.
#include "common/semantics/semantic_mapper.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <tuple>

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

TEST_CASE("things at walls are objects, and none lies where the robot was") {
  std::vector<Pose2> places;
  for (int k = 0; k < 40; ++k) places.push_back({1.5 * std::cos(0.16 * k) - 0.3, 0.8 * std::sin(0.16 * k), 0.16 * k + 1.57});
  SemanticMapper mapper = mapper_after(test::furnished_room(), places);
  const SemanticLayers layers = mapper.update(true);
  REQUIRE_FALSE(layers.objects.empty());
  for (const Object& object : layers.objects)
    for (const Pose2& place : places) REQUIRE_FALSE(contains(object.outline, place.translation()));
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

namespace {

constexpr double kNanometre = 1e-9;

bool same_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  return (a - c).norm() < kNanometre && (b - d).norm() < kNanometre;
}

bool same_outlines(const std::vector<Eigen::Vector2d>& p, const std::vector<Eigen::Vector2d>& q) {
  return p.size() == q.size() && std::equal(p.begin(), p.end(), q.begin(), [](const auto& a, const auto& b) { return (a - b).norm() < kNanometre; });
}

/// The rooms that a door joins, as places inside them: numbers of regions tell nothing outside their run.
std::vector<Eigen::Vector2d> rooms_at(const Door& door, const SemanticLayers& layers) {
  std::vector<Eigen::Vector2d> out;
  for (const Room& room : layers.rooms)
    if (room.region == door.region_a || room.region == door.region_b) out.push_back(room.outline[0]);
  return out;
}

/// Walls stand in the order in which they were found; their ends are whole millimetres.
std::vector<Wall> by_place(std::vector<Wall> walls) {
  const auto place = [](const Wall& w) { return std::tuple(std::lround(1e3 * w.a.x()), std::lround(1e3 * w.a.y()), std::lround(1e3 * w.b.x()), std::lround(1e3 * w.b.y())); };
  std::sort(walls.begin(), walls.end(), [&](const Wall& p, const Wall& q) { return place(p) < place(q); });
  return walls;
}

void require_same_walls(const std::vector<Wall>& a, const std::vector<Wall>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    REQUIRE(same_line(a[k].a, a[k].b, b[k].a, b[k].b));
    REQUIRE(a[k].evidence == Approx(b[k].evidence));
    REQUIRE(a[k].sigma_m == Approx(b[k].sigma_m));
    for (const auto& [p, q] : {std::pair(a[k].at_a, b[k].at_a), std::pair(a[k].at_b, b[k].at_b)}) {
      REQUIRE(p.across_m == Approx(q.across_m));
      REQUIRE(p.along_m == Approx(q.along_m));
      REQUIRE(p.seen == q.seen);
    }
  }
}

void require_same(const SemanticLayers& a, const SemanticLayers& b) {
  require_same_walls(by_place(a.walls), by_place(b.walls));
  REQUIRE(a.doors.size() == b.doors.size());
  REQUIRE(a.rooms.size() == b.rooms.size());
  REQUIRE(a.objects.size() == b.objects.size());
  for (std::size_t k = 0; k < a.doors.size(); ++k) {
    REQUIRE(same_line(a.doors[k].a, a.doors[k].b, b.doors[k].a, b.doors[k].b));
    REQUIRE(a.doors[k].evidence == Approx(b.doors[k].evidence));
    REQUIRE(same_outlines(rooms_at(a.doors[k], a), rooms_at(b.doors[k], b)));
  }
  for (std::size_t k = 0; k < a.rooms.size(); ++k) {
    REQUIRE(same_outlines(a.rooms[k].outline, b.rooms[k].outline));
    REQUIRE(a.rooms[k].corridor == b.rooms[k].corridor);
    REQUIRE(a.rooms[k].explored == Approx(b.rooms[k].explored));
    REQUIRE(a.rooms[k].evidence == Approx(b.rooms[k].evidence));
  }
  for (std::size_t k = 0; k < a.objects.size(); ++k) {
    REQUIRE(same_outlines(a.objects[k].outline, b.objects[k].outline));
    REQUIRE(a.objects[k].class_name == b.objects[k].class_name);
  }
}

/// Rooms along a corridor with boxes of furniture in them; nothing stands on a raster line.
test::Plan furnished_corridor(RandomStream& random, int rooms) {
  test::Plan plan;
  test::add_box(plan, -0.33, -0.97, 4.0 * rooms + 0.33, 0.98);
  plan.erase(plan.end() - 4, plan.end());
  for (const double side : {-1.0, 1.0})
    for (int k = 0; k < rooms; ++k) {
      const double x = 4.1 * k, near = side, far = side * 5.2, door = x + random.uniform(0.5, 2.5);
      plan.push_back({{x, near}, {x, far}});
      plan.push_back({{x + 4.0, near}, {x + 4.0, far}});
      plan.push_back({{x, far}, {x + 4.0, far}});
      plan.push_back({{x, near}, {door, near}});
      plan.push_back({{door + 0.9, near}, {x + 4.1, near}});
      const double bx = x + random.uniform(0.3, 2.5), by = side * random.uniform(2.2, 4.0);
      test::add_box(plan, bx, by, bx + random.uniform(0.3, 1.2), by + random.uniform(0.3, 0.8));
    }
  return plan;
}

}  // namespace

TEST_CASE("whatever came and moved in whatever order, the map is the one that is made of it all at once") {
  // The building grows to each side, and the raster with it. No door shuts on these drives: of one that did the map remembers more than what is there.
  for (const auto& [seed, heading_rad] : {std::pair(801U, 0.0), std::pair(802U, kPi), std::pair(803U, 0.5 * kPi), std::pair(806U, -0.5 * kPi), std::pair(821U, 2.3), std::pair(837U, kPi)}) {
    const Pose2 T_map_world(0.3, -0.2, heading_rad);
    RandomStream random(seed, RandomStreamId::kLaser);
    const test::Plan plan = furnished_corridor(random, 5);
    const SensorInfo sensor = test::short_laser();
    SemanticMapper mapper{SemanticsConfig()};
    std::vector<Pose2> places;
    for (int step = 0; step < 60; ++step) {
      const double x = 0.5 + 0.33 * step, y = step % 3 == 0 ? random.uniform(-0.5, 0.5) : random.uniform(-4.5, 4.5);
      const Pose2 T_world_base(x, y, random.uniform(-3, 3));
      places.push_back(T_map_world * T_world_base);
      mapper.add_node(test::see(plan, sensor, T_world_base, &random), sensor, places.back());
      for (int moves = 0; step % 5 == 4 && moves < 4; ++moves) {
        const auto id = static_cast<std::size_t>(random.uniform(0, static_cast<double>(places.size()) - 0.01));
        places[id] = places[id] * Pose2(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.05, 0.05));
        mapper.set_pose(static_cast<NodeId>(id), places[id]);
      }
      if (step % 4 != 0 && step + 1 < 60) continue;
      const SemanticLayers incremental = mapper.update(step % 8 == 0);
      INFO("seed " << seed << ", step " << step);
      require_same(incremental, mapper.render());
    }
  }
}
