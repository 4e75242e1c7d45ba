// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/door_states.hpp"

#include <catch2/catch.hpp>

#include "common/semantics/semantic_mapper.hpp"
#include "tests/support/two_rooms.hpp"

using namespace modslam;

namespace {

constexpr std::uint64_t kSeed = 1107;

/// The rooms with a leaf in their door, hinged at the lower jamb and turned out of the wall by so much; 0: shut.
test::Plan with_leaf(double open_rad) {
  test::Plan plan = test::two_rooms();
  const Eigen::Vector2d hinge(0, -0.45);
  plan.push_back({hinge, hinge + 0.9 * Eigen::Vector2d(std::sin(open_rad), std::cos(open_rad))});
  return plan;
}

Door door_between() {
  Door door;
  door.a = {0, -0.45};
  door.b = {0, 0.45};
  return door;
}

DoorLook look(const test::Plan& plan, const Pose2& T_map_base) {
  const SensorInfo sensor = test::short_laser();
  return look_at_door(test::see(plan, sensor, T_map_base), sensor, T_map_base, door_between());
}

/// A robot in the left room of the two, which may come back when the door is another.
struct Visitor {
  SensorInfo sensor = test::short_laser();
  RandomStream random{kSeed, RandomStreamId::kLaser};
  SemanticMapper mapper{SemanticsConfig()};
  SemanticLayers layers;

  void see(const test::Plan& plan, const std::vector<Pose2>& places) {
    for (const Pose2& place : places) {
      mapper.add_node(test::see(plan, sensor, place, &random), sensor, place);
      layers = mapper.update(false);
    }
  }
};

std::vector<Pose2> stay_left(int times) {
  std::vector<Pose2> places;
  for (int k = 0; k < times; ++k) places.push_back({-1.5 - 0.1 * (k % 8), 0.6 * std::sin(k), 0.1 * k});
  return places;
}

}  // namespace

TEST_CASE("a scan says open when beams go through a door, closed when they end in it, nothing from afar or aside") {
  const Pose2 before(-1.5, 0.2, 0), aside(-0.12, -2.0, 0);
  CHECK(look(test::two_rooms(), before) == DoorLook::kOpen);
  CHECK(look(with_leaf(0), before) == DoorLook::kClosed);
  CHECK(look(with_leaf(1.5), before) == DoorLook::kOpen);
  CHECK(look(test::two_rooms(), aside) == DoorLook::kNothing);
  CHECK(look(with_leaf(0), aside) == DoorLook::kNothing);
  test::Plan hidden = test::two_rooms();
  test::add_box(hidden, -1.0, -0.8, -0.6, 0.8);
  CHECK(look(hidden, before) == DoorLook::kNothing);
  Scan empty;
  CHECK(look_at_door(empty, test::short_laser(), before, door_between()) == DoorLook::kNothing);
}

TEST_CASE("a door that shuts is closed after a few looks and open again after a few more, with the same id and rooms") {
  Visitor visitor;
  visitor.see(test::two_rooms(), test::drive_through_two_rooms());
  REQUIRE(visitor.layers.doors.size() == 1);
  const Door first = visitor.layers.doors[0];
  CHECK_FALSE(first.closed);
  visitor.see(with_leaf(0), stay_left(4));
  REQUIRE(visitor.layers.doors.size() == 1);
  CHECK(visitor.layers.doors[0].closed);
  visitor.see(with_leaf(0), stay_left(150));  // by now the leaf is a wall on the map
  REQUIRE(visitor.layers.doors.size() == 1);
  const Door& shut = visitor.layers.doors[0];
  CHECK(shut.closed);
  CHECK(shut.id == first.id);
  CHECK(std::set<std::int64_t>{shut.room_a, shut.room_b} == std::set<std::int64_t>{first.room_a, first.room_b});
  visitor.see(test::two_rooms(), stay_left(4));
  REQUIRE(visitor.layers.doors.size() == 1);
  CHECK_FALSE(visitor.layers.doors[0].closed);
  CHECK(visitor.layers.doors[0].id == first.id);
}

TEST_CASE("a shut door moves with the nodes that saw it") {
  Visitor visitor;
  visitor.see(test::two_rooms(), test::drive_through_two_rooms());
  visitor.see(with_leaf(0), stay_left(150));
  REQUIRE(visitor.layers.doors.size() == 1);
  const Pose2 shift(3, -2, 0.3);
  const auto places = test::drive_through_two_rooms();
  std::vector<Pose2> all(places.begin(), places.end());
  for (const Pose2& place : stay_left(150)) all.push_back(place);
  const Eigen::Vector2d before = visitor.layers.doors[0].centre();
  for (std::size_t k = 0; k < all.size(); ++k) visitor.mapper.set_pose(static_cast<NodeId>(k), shift * all[k]);
  const SemanticLayers moved = visitor.mapper.update(true);
  REQUIRE(moved.doors.size() == 1);
  CHECK((moved.doors[0].centre() - shift * before).norm() < 0.15);
  CHECK(moved.doors[0].closed);
}

TEST_CASE("an opening that was never seen through does not outlive itself") {
  DoorStates states;
  SemanticLayers before, now;
  before.doors = {door_between()};
  before.doors[0].id = 7;
  const test::Plan plan = with_leaf(0);
  const SensorInfo sensor = test::short_laser();
  const Pose2 place(-1.5, 0, 0);
  const Scan scan = test::see(plan, sensor, place);
  const auto view = [&](std::size_t) { return DoorStates::View{scan, sensor, place}; };
  SemanticLayers first = before;
  states.update({}, first, 5, view);
  REQUIRE(first.doors.size() == 1);
  CHECK(first.doors[0].closed);
  states.update(first, now, 6, view);
  CHECK(now.doors.empty());
}
