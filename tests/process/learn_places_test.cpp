// SPDX-License-Identifier: BSD-3-Clause
#include <catch2/catch.hpp>

#include "common/world/obstacles.hpp"
#include "procs/learn_places/drive.hpp"
#include "procs/learn_places/learn.hpp"
#include "procs/learn_places/office_maker.hpp"

using namespace modslam;

namespace {

std::array<int, kPlaceKinds> count_of(const PlacePath& path) {
  std::array<int, kPlaceKinds> count{};
  for (const PlaceSample& sample : path) ++count[static_cast<std::size_t>(sample.kind)];
  return count;
}

}  // namespace

TEST_CASE("a made-up office can be driven through, bare and furnished, and shows every kind of place") {
  const World office = make_office(3);
  REQUIRE(office.rooms.size() > 4);
  REQUIRE(office.doors.size() + 2 >= office.rooms.size());
  const PlacePath bare = drive(office, office.routes[0], {}), full = drive(furnished(office, office.routes[0], 5), office.routes[0], {});
  for (const PlacePath& path : {bare, full})
    for (const int count : count_of(path)) REQUIRE(count >= 10);
  REQUIRE(full.size() == bare.size());  // no furniture stands in the way
  REQUIRE(furnished(office, office.routes[0], 5).objects.size() > 3);
}

TEST_CASE("the same seed makes the same office, another seed another one") {
  REQUIRE(make_office(4).walls[1].b == make_office(4).walls[1].b);
  REQUIRE(make_office(4).walls[1].b != make_office(5).walls[1].b);
}

TEST_CASE("a building drawn larger is passed with more nodes, and doors stay doors") {
  const World office = make_office(3);
  DriveOptions larger;
  larger.scale = 1.5;
  const PlacePath at_scale = drive(office, office.routes[0], {}), large = drive(office, office.routes[0], larger);
  REQUIRE(large.size() > at_scale.size());
  REQUIRE(count_of(large)[2] >= 10);
}

TEST_CASE("a place is told by the world: near a door's line, in a corridor, in a room, nowhere") {
  World world;
  world.rooms = {{"a", "office", "A", {{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {}},
                 {"b", "corridor", "B", {{4, 0}, {9, 0}, {9, 4}, {4, 4}}, {{{6, 1}, {7, 1}, {7, 2}, {6, 2}}}},
                 {"c", "corridor", "HALL", {{0, 4}, {9, 4}, {9, 9}, {0, 9}}, {}}};
  world.doors = {{"d", {4, 1}, {4, 2}, 1, true}};
  PlaceKind kind{};
  REQUIRE((place_in(world, {4.3, 1.5}, kind) && kind == PlaceKind::kDoorway));
  REQUIRE((place_in(world, {4.5, 1.5}, kind) && kind == PlaceKind::kCorridor));
  REQUIRE((place_in(world, {1, 1}, kind) && kind == PlaceKind::kRoom));
  REQUIRE((place_in(world, {3, 7}, kind) && kind == PlaceKind::kRoom));
  REQUIRE_FALSE(place_in(world, {6.5, 1.5}, kind));
  REQUIRE_FALSE(place_in(world, {20, 1.5}, kind));
}

TEST_CASE("confusions count what is against what was said") {
  Confusion confusion;
  REQUIRE(confusion.accuracy() == 0);
  confusion.counts = {{{8, 1, 1}, {2, 8, 0}, {0, 0, 5}}};
  REQUIRE(confusion.accuracy() == Approx(21.0 / 25));
  REQUIRE(confusion.recall(PlaceKind::kRoom) == Approx(0.8));
  REQUIRE(confusion.precision(PlaceKind::kDoorway) == Approx(5.0 / 6));
}
