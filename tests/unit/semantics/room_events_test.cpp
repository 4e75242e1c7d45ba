// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/room_events.hpp"

#include <catch2/catch.hpp>

#include "common/semantics/semantic_mapper.hpp"
#include "tests/support/two_rooms.hpp"

using namespace modslam;

namespace {

using Ids = std::vector<std::int64_t>;
using Kind = RoomEvent::Kind;

Room room(std::int64_t id, double x0, double y0, double x1, double y1) {
  Room r;
  r.id = id;
  r.outline = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  r.area_m2 = (x1 - x0) * (y1 - y0);
  return r;
}

void require_one(const std::vector<RoomEvent>& events, Kind kind, const Ids& before, const Ids& after) {
  REQUIRE(events.size() == 1);
  REQUIRE(events[0].kind == kind);
  REQUIRE(events[0].before == before);
  REQUIRE(events[0].after == after);
}

}  // namespace

TEST_CASE("two rooms in one are a merge, whether or not one of them gave it its id") {
  const std::vector<Room> two = {room(4, 0, 0, 4, 6), room(7, 4, 0, 8, 6)};
  require_one(room_events(two, {room(7, 0, 0, 8, 6)}), Kind::kMerge, {4, 7}, {7});
  require_one(room_events(two, {room(9, 0, 0, 8, 6)}), Kind::kMerge, {4, 7}, {9});
}

TEST_CASE("one room in two is a split") {
  const std::vector<Room> one = {room(4, 0, 0, 8, 6)};
  require_one(room_events(one, {room(4, 0, 0, 5, 6), room(5, 5, 0, 8, 6)}), Kind::kSplit, {4}, {4, 5});
  require_one(room_events(one, {room(5, 0, 0, 3, 6), room(6, 3, 0, 5, 6), room(7, 5, 0, 8, 6)}), Kind::kSplit, {4}, {5, 6, 7});
}

TEST_CASE("a room that grows, shrinks, moves, appears or vanishes is neither") {
  const std::vector<Room> one = {room(4, 0, 0, 4, 6)};
  REQUIRE(room_events(one, one).empty());
  REQUIRE(room_events(one, {room(4, 0, 0, 5, 6), room(5, 5, 0, 9, 6)}).empty());
  REQUIRE(room_events(one, {room(4, 0, 0, 2.5, 6)}).empty());
  REQUIRE(room_events(one, {room(5, 0, 0, 1, 6)}).empty());  // another one in its place
  REQUIRE(room_events(one, {}).empty());
  REQUIRE(room_events({}, one).empty());
  REQUIRE(room_events({room(4, 0, 0, 4, 6), room(5, 4, 0, 8, 6)}, {room(4, 0, 0, 4, 6)}).empty());
}

TEST_CASE("merges and splits of one update are told apart, and a room without corners is no trouble") {
  const std::vector<Room> before = {room(1, 0, 0, 4, 4), room(2, 4, 0, 8, 4), room(3, 20, 0, 28, 4)};
  Room empty;
  empty.id = 99;
  const auto events = room_events(before, {room(1, 0, 0, 8, 4), room(3, 20, 0, 24, 4), room(6, 24, 0, 28, 4), empty});
  REQUIRE(events.size() == 2);
  REQUIRE(events[0].kind == Kind::kMerge);
  REQUIRE(events[0].before == Ids{1, 2});
  REQUIRE(events[1].kind == Kind::kSplit);
  REQUIRE(events[1].after == Ids{3, 6});
}

TEST_CASE("when the wall between two rooms is taken away they merge, and when it is put back they split") {
  const SensorInfo sensor = test::short_laser();
  RandomStream random(712, RandomStreamId::kLaser);
  test::Plan hall;
  test::add_box(hall, -4, -3, 4, 3);
  SemanticMapper mapper{SemanticsConfig()};
  std::vector<std::vector<RoomEvent>> told;
  const auto drive = [&](const test::Plan& plan, int laps) {
    for (int lap = 0; lap < laps; ++lap)
      for (const Pose2& place : test::drive_through_two_rooms()) mapper.add_node(test::see(plan, sensor, place, &random), sensor, place);
    const SemanticLayers& layers = mapper.update(false);
    told.push_back(layers.room_events);
    Ids ids;
    for (const Room& r : layers.rooms) ids.push_back(r.id);
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  const Ids two = drive(test::two_rooms(), 1);
  REQUIRE(two.size() == 2);
  REQUIRE(told.back().empty());
  const Ids one = drive(hall, 6);
  REQUIRE(one.size() == 1);
  require_one(told.back(), Kind::kMerge, two, one);
  const Ids again = drive(test::two_rooms(), 40);
  REQUIRE(again.size() == 2);
  require_one(told.back(), Kind::kSplit, one, again);
  mapper.update(true);
  REQUIRE(mapper.update(true).room_events.empty());
}
