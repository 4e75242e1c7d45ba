// SPDX-License-Identifier: BSD-3-Clause
/// The door sensor on single scans, and the openings of the floor that are doors.
#include <catch2/catch.hpp>

#include "common/semantics/door_map.hpp"
#include "common/semantics/door_sensor.hpp"
#include "tests/support/floor_raster.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;

namespace {

/// A room whose upper wall has an opening around x = 0, and another wall behind it (or nothing).
test::Plan room_with_opening(double width_m, bool wall_behind = true) {
  const double h = width_m / 2;
  test::Plan plan = {{{-3, 2}, {-h, 2}}, {{h, 2}, {3, 2}}, {{-3, 2}, {-3, -2}}, {{3, 2}, {3, -2}}, {{-3, -2}, {3, -2}}};
  if (wall_behind) plan.push_back({{-8, 4}, {8, 4}});
  return plan;
}

std::vector<DoorSighting> sight(const test::Plan& plan, const Pose2& T_map_base) {
  const SensorInfo sensor = test::short_laser();
  std::vector<DoorSighting> sightings = sight_doors(test::see(plan, sensor, T_map_base), sensor, {});
  for (DoorSighting& s : sightings) s = {T_map_base * s.a, T_map_base * s.b};
  return sightings;
}

/// Two rooms one above the other, the wall between at y = 2.5 has a door from x = 2 to 2.9.
struct Scene {
  KnownSpace space = test::unknown_floor(6, 6);
  std::vector<DoorSighting> sightings;
  Scene() {
    test::fill(space, 0.4, 0.4, 5.6, 5.6, test::kSolid);
    test::fill(space, 0.5, 0.5, 5.5, 5.5, test::kFree);
    test::fill(space, 0.5, 2.4, 5.5, 2.6, test::kSolid);
    test::fill(space, 2, 2.4, 2.9, 2.6, test::kFree);
  }
  std::vector<Door> doors() const {
    const Floor floor = make_floor(space, 14);
    return find_doors(part_floor(floor, space, {}, find_openings(floor, space, {}, 3.5, OpeningModel()), {}), sightings, {});
  }
};

}  // namespace

TEST_CASE("an opening is sighted between its jambs, from ahead and from aside, into a room and into nothing") {
  for (const bool wall_behind : {true, false})
    for (const Pose2& eye : {Pose2(0, 0, 0), Pose2(0.2, -1, 2), Pose2(-0.9, 0.5, -1)}) {
      const auto sightings = sight(room_with_opening(0.9, wall_behind), eye);
      REQUIRE_FALSE(sightings.empty());
      for (const DoorSighting& s : sightings) {
        REQUIRE((0.5 * (s.a + s.b) - Eigen::Vector2d(0, 2)).norm() < 0.15);
        REQUIRE((s.b - s.a).norm() == Approx(0.9).margin(0.15));
      }
    }
}

TEST_CASE("a slit, a passage of two metres and a closed wall are no doors") {
  for (const double width_m : {0.3, 2.2, 0.0}) REQUIRE(sight(room_with_opening(width_m), {0, 0, 0}).empty());
  REQUIRE(sight_doors(Scan(), test::short_laser(), {}).empty());
}

TEST_CASE("an opening of a wall is a door at its jambs, and each sighting of it adds evidence") {
  Scene scene;
  const auto unseen = scene.doors();
  REQUIRE(unseen.size() == 1);
  REQUIRE((unseen[0].centre() - Eigen::Vector2d(2.45, 2.5)).norm() < 0.15);
  REQUIRE(unseen[0].width_m() == Approx(0.9).margin(0.12));
  for (int k = 0; k < 6; ++k) scene.sightings.push_back({{2.05, 2.4 + 0.02 * k}, {2.85, 2.45}});
  scene.sightings.push_back({{4.05, 2.4}, {4.85, 2.45}});  // of something else
  REQUIRE(scene.doors()[0].evidence == Approx(unseen[0].evidence + 6 * 0.4));
}

TEST_CASE("an opening that is shut or was never seen is no door") {
  Scene shut;
  test::fill(shut.space, 2, 2.4, 2.9, 2.6, test::kSolid);
  REQUIRE(shut.doors().empty());
  Scene unseen;
  test::fill(unseen.space, 2, 2.4, 2.9, 2.6, test::kUnknown);
  REQUIRE(unseen.doors().empty());
}

TEST_CASE("a door in the corner of a room has the wall across for its second jamb") {
  Scene scene;
  test::fill(scene.space, 2, 2.4, 2.9, 2.6, test::kSolid);
  test::fill(scene.space, 4.6, 2.4, 5.5, 2.6, test::kFree);
  const auto doors = scene.doors();
  REQUIRE(doors.size() == 1);
  REQUIRE(doors[0].width_m() == Approx(0.9).margin(0.12));
}

TEST_CASE("without floor there are no doors, whatever was sighted") {
  Scene scene;
  scene.space.occupancy.setTo(test::kUnknown);
  scene.sightings.assign(6, {{2.05, 2.4}, {2.85, 2.45}});
  REQUIRE(scene.doors().empty());
}

TEST_CASE("noise of any kind makes openings that all have finite features and a probability") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    RandomStream random(seed, RandomStreamId::kLaser);
    KnownSpace space = test::unknown_floor(8, 8);
    for (std::uint8_t& cell : space.occupancy) {
      const double draw = random.uniform();
      cell = draw < 0.1 ? test::kSolid : draw < 0.2 ? test::kUnknown : test::kFree;
    }
    const Floor floor = make_floor(space, 14);
    for (const Opening& opening : find_openings(floor, space, {}, 3.5, OpeningModel())) {
      REQUIRE(opening.probability >= 0);
      REQUIRE(opening.probability <= 1);
      for (const float feature : opening.features) REQUIRE(std::isfinite(feature));
    }
  }
}
