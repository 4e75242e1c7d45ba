// SPDX-License-Identifier: BSD-3-Clause
/// Outlines, rooms and objects on floors drawn by hand.
#include <catch2/catch.hpp>

#include "common/semantics/door_map.hpp"
#include "common/semantics/object_finder.hpp"
#include "common/semantics/room_finder.hpp"
#include "tests/support/floor_raster.hpp"

using namespace modslam;

namespace {

constexpr double kRim_m = 0.085;  // the wall's own cell of 0.1 m is not the room's

bool counter_clockwise(const std::vector<Eigen::Vector2d>& outline) {
  double twice = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d &p = outline[k], &q = outline[(k + 1) % outline.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return twice > 0;
}

Partition parted(const KnownSpace& space) {
  const Floor floor = make_floor(space, 14);
  return part_floor(floor, space, {}, find_openings(floor, space, {}, 3.5, OpeningModel()), {});
}

ObjectMap objects_of(const KnownSpace& space) {
  const Boxes all{cv::Rect({0, 0}, space.occupancy.size())};
  Floor floor;
  ObjectMap objects;
  const FloorChange change = update_floor(floor, space, 14, all);
  if (!space.empty()) update_objects(objects, space, floor, all, change.islands);
  return objects;
}

std::vector<Room> rooms_of(const KnownSpace& space) { return find_rooms(parted(space), make_floor(space, 14), space, {}); }

/// 10 x 6 m of floor, cut at x = 6 by a wall of 0.2 m with a door from y = 2 to 2.9; a margin of 1 m unknown.
struct TwoRooms {
  KnownSpace space = test::unknown_floor(12, 8);
  TwoRooms() {
    test::fill(space, 0.9, 0.9, 11.1, 7.1, test::kSolid);
    test::fill(space, 1, 1, 11, 7, test::kFree);
    test::fill(space, 6.9, 1, 7.1, 7, test::kSolid);
    test::fill(space, 6.9, 3, 7.1, 3.9, test::kFree);
  }
};

}  // namespace

TEST_CASE("an outline has the area of its mask, runs counter-clockwise, and leaves a block out") {
  const KnownSpace space = test::unknown_floor(12, 12);
  cv::Mat1b mask(space.occupancy.size(), std::uint8_t{0});
  mask(cv::Rect(10, 10, 100, 100)).setTo(255);
  REQUIRE(polygon_area_m2(outline_of(mask, space, 3, 0.15)) == Approx(100).epsilon(0.015));
  mask(cv::Rect(40, 40, 40, 40)).setTo(0);
  const auto ring = outline_of(mask, space, 3, 0.15);
  REQUIRE(polygon_area_m2(ring) == Approx(84).epsilon(0.025));
  REQUIRE(counter_clockwise(ring));
  REQUIRE(contains(ring, {2, 2}));
  REQUIRE(contains(ring, {10, 6}));
  REQUIRE_FALSE(contains(ring, {6, 6}));
  REQUIRE(polygon_area_m2(outline_of(mask, space, 30, 0.15)) == Approx(100).epsilon(0.015));  // too small a hole to tell
}

TEST_CASE("an empty mask and a single cell have no outline that breaks anything") {
  const KnownSpace space = test::unknown_floor(2, 2);
  cv::Mat1b mask(space.occupancy.size(), std::uint8_t{0});
  REQUIRE(outline_of(mask, space, 1, 0.1).empty());
  mask(5, 5) = 255;
  REQUIRE(polygon_area_m2(outline_of(mask, space, 1, 0.1)) < 0.02);
  REQUIRE_FALSE(contains({}, {0, 0}));
}

TEST_CASE("cars parked in a row and the gaps between them are one room with the hall they stand in") {
  KnownSpace space = test::unknown_floor(22, 12);
  test::fill(space, 1, 1, 20.2, 10.2, test::kSolid);
  test::fill(space, 1.1, 1.1, 20.1, 10.1, test::kFree);
  for (int car = 0; car < 6; ++car) test::fill_thing(space, 2.1 + 3 * car, 6.1, 3.9 + 3 * car, 10.2);
  const auto rooms = rooms_of(space);
  REQUIRE(rooms.size() == 1);
  REQUIRE(rooms[0].area_m2 == Approx(19 * 9).margin(56 * kRim_m));
}

TEST_CASE("two rooms with a door between are two rooms, and the door names both") {
  const TwoRooms plan;
  const Partition partition = parted(plan.space);
  auto rooms = find_rooms(partition, make_floor(plan.space, 14), plan.space, {});
  REQUIRE(rooms.size() == 2);
  REQUIRE(rooms[0].area_m2 + rooms[1].area_m2 == Approx(5.9 * 6 + 3.9 * 6).margin((23.8 + 19.8) * kRim_m));
  rooms[0].id = 7;
  rooms[1].id = 9;
  auto doors = find_doors(partition, std::vector<DoorSighting>(), {});
  REQUIRE(doors.size() == 1);
  join_rooms(doors, rooms);
  REQUIRE(std::min(doors[0].room_a, doors[0].room_b) == 7);
  REQUIRE(std::max(doors[0].room_a, doors[0].room_b) == 9);
  for (const Room& room : rooms) {
    REQUIRE(room.explored > 0.95);
    REQUIRE(room.evidence > 0.9);
    REQUIRE_FALSE(room.corridor);
  }
}

TEST_CASE("a slit in the wall between two rooms does not make them one, as it would if only sure openings were cut") {
  TwoRooms rooms;
  test::fill(rooms.space, 6.9, 5.4, 7.1, 5.9, test::kFree);
  const Floor floor = make_floor(rooms.space, 14);
  const auto opening = [](double from, double to, double probability) {
    Opening out;
    out.a = {7, from};
    out.b = {7, to};
    out.probability = probability;
    return out;
  };
  const std::vector<Opening> openings{opening(2.95, 3.95, 0.9), opening(5.35, 5.95, 0.2)};
  const auto regions = [&](double slit_m) {
    PartitionOptions options;
    options.cuts.slit_m = slit_m;
    return part_floor(floor, rooms.space, {}, openings, options).regions.size();
  };
  REQUIRE(regions(0.7) == 2);
  REQUIRE(regions(0.3) == 1);
}

TEST_CASE("a wall that ends in the middle of a hall does not part it") {
  TwoRooms plan;
  test::fill(plan.space, 6.9, 3, 7.1, 7, test::kFree);
  REQUIRE(rooms_of(plan.space).size() == 1);
}

TEST_CASE("a cupboard in a room's corner leaves the room its corner") {
  TwoRooms plan;
  test::fill(plan.space, 1, 6, 3, 7, test::kUnknown);
  test::fill(plan.space, 1, 5.9, 3.1, 6, test::kSolid);
  test::fill(plan.space, 3, 5.9, 3.1, 7, test::kSolid);
  const auto rooms = rooms_of(plan.space);
  REQUIRE(rooms.size() == 2);
  REQUIRE(std::max(rooms[0].area_m2, rooms[1].area_m2) == Approx(5.9 * 6).margin(23.8 * kRim_m));
}

TEST_CASE("a closed room keeps its box when furniture hides more than a third of it, and not when that is as large as a room") {
  for (const bool room_sized : {false, true}) {
    const double length = room_sized ? 9.0 : 5.0, half = room_sized ? 1.8 : 1.3;
    KnownSpace space = test::unknown_floor(12, 7);
    test::fill(space, 0.9, 0.9, 1.1 + length, 5.1, test::kSolid);
    test::fill(space, 1, 1, 1 + length, 5, test::kFree);
    test::fill(space, 0.4 * length + 1, 3 - half, 1.1 + length, 3 + half, test::kSolid);
    test::fill(space, 0.4 * length + 1.1, 3 - half + 0.1, 1.1 + length, 2.9 + half, 0);
    const auto rooms = rooms_of(space);
    REQUIRE_FALSE(rooms.empty());
    REQUIRE(contains(rooms[0].outline, {0.4 * length + 2, 3}) != room_sized);
    if (!room_sized) REQUIRE(rooms[0].area_m2 == Approx(5 * 4).margin(18 * kRim_m + 0.5));
  }
}

TEST_CASE("a wall across a corner of the room's box leaves the corner outside, a cupboard of that size does not") {
  for (const bool askew : {true, false}) {
    KnownSpace space = test::unknown_floor(9, 8);
    test::fill(space, 0.9, 0.9, 8.1, 7.1, test::kSolid);
    test::fill(space, 1, 1, 8, 7, test::kFree);
    const std::vector<cv::Point> corner = askew ? std::vector<cv::Point>{{80, 50}, {80, 70}, {60, 70}} : std::vector<cv::Point>{{68, 52}, {80, 52}, {80, 70}, {68, 70}};
    cv::fillConvexPoly(space.occupancy, corner, cv::Scalar(test::kUnknown));
    cv::polylines(space.occupancy, std::vector<std::vector<cv::Point>>{corner}, true, cv::Scalar(test::kSolid), 2);
    const auto rooms = rooms_of(space);
    REQUIRE(rooms.size() == 1);
    REQUIRE(contains(rooms[0].outline, {7.7, 6.7}) != askew);
  }
}

TEST_CASE("an unexplored rectangle between walls is no room, nor is open floor without walls") {
  TwoRooms plan;
  test::fill(plan.space, 7.1, 1, 11, 7, test::kUnknown);
  REQUIRE(rooms_of(plan.space).size() == 1);
  KnownSpace open = test::unknown_floor(8, 8);
  test::fill(open, 1, 1, 7, 7, test::kFree);
  REQUIRE(rooms_of(open).empty());
  REQUIRE(rooms_of(KnownSpace(0.1)).empty());
}

/// A hall with a small room beside it; beams leave the room through a window of so much and show a fan outside.
KnownSpace room_with_window(double window_m) {
  KnownSpace space = test::unknown_floor(17, 9);
  test::fill(space, 0.9, 0.9, 11.9, 7.1, test::kSolid);
  test::fill(space, 1, 1, 9, 7, test::kFree);
  test::fill(space, 9.2, 1, 11.8, 3.6, test::kFree);
  test::fill(space, 9, 1.8, 9.2, 2.7, test::kFree);
  for (double x = 11.8; x < 15; x += 0.1) {
    const double half_m = 0.5 * window_m + std::max(0.0, 0.35 * (x - 12));
    test::fill(space, x, std::max(0.1, 2.3 - half_m), x + 0.1, 2.3 + half_m, test::kFree);
  }
  return space;
}

/// The same floor parted at the door alone: room and fan are one region.
Partition parted_at_door(const KnownSpace& space) {
  Partition partition;
  partition.labels = cv::Mat1i(space.occupancy.size(), 0);
  for (const int number : {1, 2}) partition.regions.push_back({number, {}, 0, false, 1});
  for (int y = 0; y < space.occupancy.rows; ++y)
    for (int x = 0; x < space.occupancy.cols; ++x)
      if (space.is_free({x, y}) && x != 91) partition.labels(y, x) = x < 91 ? 1 : 2;
  for (FloorRegion& region : partition.regions) {
    cv::Mat1b mask;
    cv::inRange(partition.labels, region.number, region.number, mask);
    region.box = cv::boundingRect(mask);
    region.cells = cv::countNonZero(mask);
  }
  CutOpening cut;
  cut.opening.a = {9.15, 1.8};
  cut.opening.b = {9.15, 2.7};
  cut.left = 1;
  cut.right = 2;
  partition.cuts = {cut};
  return partition;
}

TEST_CASE("what beams show through a window does not undo the room, and is none itself") {
  const auto rooms_behind = [](double window_m) {
    const KnownSpace space = room_with_window(window_m);
    return find_rooms(parted_at_door(space), make_floor(space, 14), space, {});
  };
  const auto rooms = rooms_behind(0.3);
  REQUIRE(rooms.size() == 2);
  const Room& small = rooms[0].area_m2 < rooms[1].area_m2 ? rooms[0] : rooms[1];
  CHECK(small.area_m2 == Approx(2.6 * 2.6).epsilon(0.15));
  CHECK(contains(small.outline, {10.5, 2.3}));
  CHECK_FALSE(contains(small.outline, {13.5, 2.3}));
  CHECK(rooms_behind(0.8).size() == 1);  // a gap that one can walk through: who knows what that is
}

TEST_CASE("a corridor that runs round a block has the block as a hole") {
  KnownSpace space = test::unknown_floor(12, 12);
  test::fill(space, 1.9, 1.9, 10.1, 10.1, test::kSolid);
  test::fill(space, 2, 2, 10, 10, test::kFree);
  test::fill_thing(space, 4, 4, 8, 8);
  const auto rooms = rooms_of(space);
  REQUIRE(rooms.size() == 1);
  REQUIRE(rooms[0].area_m2 == Approx(64 - 16).margin((32 + 16) * kRim_m));
  REQUIRE_FALSE(contains(rooms[0].outline, {6, 6}));
  REQUIRE(contains(rooms[0].outline, {3, 6}));
  REQUIRE(rooms[0].corridor);
  REQUIRE(rooms[0].explored > 0.95);
}

TEST_CASE("a box of a car's size that stands free is a car; a pillar is a pillar") {
  KnownSpace space = test::unknown_floor(12, 10);
  test::fill(space, 0.5, 0.5, 11.5, 9.5, test::kFree);
  test::fill_thing(space, 3, 3, 7.4, 4.8);
  test::fill(space, 9, 7, 9.4, 7.4, test::kSolid);
  const ObjectMap found = objects_of(space);
  REQUIRE(found.objects.size() == 2);
  REQUIRE(found.objects[0].object.class_name == "car");
  REQUIRE(found.objects[0].object.area_m2 == Approx(4.4 * 1.8).epsilon(0.05));
  REQUIRE(found.objects[1].object.class_name == "pillar");
  REQUIRE(found.mask(space.cell({5, 4})) == 255);
  REQUIRE(found.mask(space.cell({2, 2})) == 0);
}

TEST_CASE("a long thin island is a piece of wall, a big block is building, a shadow is nothing") {
  KnownSpace space = test::unknown_floor(12, 10);
  test::fill(space, 0.5, 0.5, 11.5, 9.5, test::kFree);
  test::fill(space, 2, 2, 4, 2.2, test::kSolid);
  test::fill_thing(space, 5, 4, 9.5, 8.5);
  test::fill(space, 2, 6, 3, 7, test::kUnknown);
  const ObjectMap found = objects_of(space);
  REQUIRE(found.objects.empty());
  REQUIRE(cv::countNonZero(found.mask) == 0);
  REQUIRE(objects_of(KnownSpace(0.1)).objects.empty());
}

TEST_CASE("a small nook without walls around it joins the room it opens to") {
  const TwoRooms plan;
  KnownSpace space = plan.space;
  test::fill(space, 1, 6, 2.5, 6.1, test::kSolid);  // a box and the wall close a nook in but for a gap
  test::fill(space, 3.2, 5, 3.3, 7, test::kSolid);
  const Floor floor = make_floor(space, 14);
  std::vector<Wall> walls;
  test::add_faces(walls, 7.1, 1, 11, 7);
  const Partition partition = part_floor(floor, space, walls, find_openings(floor, space, walls, 3.5, OpeningModel()), {});
  const cv::Point nook = space.cell({1.6, 6.5}), room = space.cell({4, 2});
  REQUIRE(partition.labels(nook) == partition.labels(room));
}
