// SPDX-License-Identifier: BSD-3-Clause
/// The door sensor on single scans, and the gaps of the wall map that its sightings make doors.
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

Wall wall(double ax, double ay, double bx, double by) {
  Wall w;
  w.a = {ax, ay};
  w.b = {bx, by};
  return w;
}

/// A wall along y = 2.5 from x = 0 to 5 with a door from x = 2 to 2.9, in free floor.
struct Scene {
  KnownSpace space = test::unknown_floor(5, 5);
  std::vector<WallBand> bands = {{{wall(0, 2.45, 2, 2.45), wall(2.9, 2.45, 5, 2.45)}}};
  std::vector<DoorSighting> sightings;
  Scene() {
    test::fill(space, 0, 0, 5, 5, test::kFree);
    test::fill(space, 0, 2.4, 2, 2.6, test::kSolid);
    test::fill(space, 2.9, 2.4, 5, 2.6, test::kSolid);
    for (int k = 0; k < 6; ++k) sightings.push_back({{2.05, 2.4 + 0.02 * k}, {2.85, 2.45}});
  }
  std::vector<Door> doors() const { return find_doors(bands, sightings, space, {}); }
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

TEST_CASE("a free gap of a wall that scans looked through is a door at its jambs") {
  const auto doors = Scene().doors();
  REQUIRE(doors.size() == 1);
  REQUIRE((doors[0].centre() - Eigen::Vector2d(2.45, 2.45)).norm() < 0.05);
  REQUIRE(doors[0].width_m() == Approx(0.9).margin(0.02));
  REQUIRE(doors[0].evidence == Approx(6 * 0.4));
}

TEST_CASE("a gap too few scans looked through, or that is not free, is no door") {
  Scene few;
  few.sightings.resize(3);
  REQUIRE(few.doors().empty());
  Scene shut;
  test::fill(shut.space, 2, 2.4, 2.9, 2.6, test::kSolid);
  REQUIRE(shut.doors().empty());
  Scene unseen;
  test::fill(unseen.space, 2, 2.4, 2.9, 2.6, test::kUnknown);
  REQUIRE(unseen.doors().empty());
}

TEST_CASE("the two faces of a wall share one door, which lies between them") {
  Scene scene;
  scene.bands.push_back({{wall(5, 2.6, 2.9, 2.6), wall(2, 2.6, 0, 2.6)}});
  const auto doors = scene.doors();
  REQUIRE(doors.size() == 1);
  REQUIRE(doors[0].centre().y() == Approx(2.525).margin(0.01));
}

TEST_CASE("a door in the corner of a room has the wall across for its second jamb") {
  Scene scene;
  scene.bands = {{{wall(0, 2.45, 2, 2.45)}}, {{wall(2.9, 0, 2.9, 5)}}};
  const auto doors = scene.doors();
  REQUIRE(doors.size() == 1);
  REQUIRE(doors[0].width_m() == Approx(0.9).margin(0.02));
}

TEST_CASE("without walls there are no doors, whatever was sighted") {
  Scene scene;
  scene.bands.clear();
  REQUIRE(scene.doors().empty());
}
