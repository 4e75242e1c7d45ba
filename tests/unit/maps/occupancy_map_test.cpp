// SPDX-License-Identifier: BSD-3-Clause
#include "common/maps/occupancy_map.hpp"

#include "common/maps/map_builder.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

using Tiles = std::map<OccupancyMap::TileIndex, std::vector<std::uint8_t>>;

/// Every tile that shows something.
Tiles rendered(const OccupancyMap& map) {
  Tiles out;
  for (const auto& index : map.tiles()) {
    const auto tile = map.render(index);
    if (std::any_of(tile.begin(), tile.end(), [](std::uint8_t c) { return c != 0; })) out[index] = tile;
  }
  return out;
}

int cell(const OccupancyMap& map, double x_m, double y_m) {
  const int i = static_cast<int>(std::floor(x_m / map.resolution_m())), j = static_cast<int>(std::floor(y_m / map.resolution_m()));
  const auto tile_of = [](int k) { return static_cast<int>(std::floor(static_cast<double>(k) / OccupancyMap::kTileCells)); };
  const int I = tile_of(i), J = tile_of(j);
  return map.render({I, J})[static_cast<std::size_t>((j - J * OccupancyMap::kTileCells) * OccupancyMap::kTileCells + i - I * OccupancyMap::kTileCells)];
}

/// One beam along the robot's x axis.
Scan one_beam(float range_m) {
  Scan scan;
  scan.ranges_m = {range_m};
  return scan;
}

}  // namespace

TEST_CASE("one beam of a metre: free up to its end, occupied there, unknown beyond and beside") {
  OccupancyMap map(0.1, 30);
  SensorInfo sensor;
  map.insert(one_beam(1.0f), sensor, {0.05, 0.05, 0});
  for (double x = 0.05; x < 1.0; x += 0.1) {
    REQUIRE(cell(map, x, 0.05) > 0);
    REQUIRE(cell(map, x, 0.05) < 100);
  }
  REQUIRE(cell(map, 1.05, 0.05) > 200);
  REQUIRE(cell(map, 1.15, 0.05) == 0);
  REQUIRE(cell(map, 0.55, 0.15) == 0);
}

TEST_CASE("what is drawn and taken out again leaves an empty map, whatever came between") {
  const SensorInfo sensor = short_laser();
  RandomStream random(131, RandomStreamId::kLaser);
  OccupancyMap map(0.05, 8.0);
  std::vector<std::pair<Scan, Pose2>> drawn;
  for (int k = 0; k < 30; ++k) {
    const Pose2 pose(random.uniform(-2, 2), random.uniform(-1, 1), random.uniform(-kPi, kPi));
    drawn.emplace_back(see(furnished_room(), sensor, pose, &random), pose);
    map.insert(drawn.back().first, sensor, pose);
  }
  REQUIRE(rendered(map).size() >= 4);
  for (int k = 29; k >= 0; k -= 2) map.remove(drawn[static_cast<std::size_t>(k)].first, sensor, drawn[static_cast<std::size_t>(k)].second);
  OccupancyMap half(0.05, 8.0);
  for (std::size_t k = 0; k < 30; k += 2) half.insert(drawn[k].first, sensor, drawn[k].second);
  REQUIRE(rendered(map) == rendered(half));
  for (std::size_t k = 0; k < 30; k += 2) map.remove(drawn[k].first, sensor, drawn[k].second);
  REQUIRE(rendered(map).empty());
}

TEST_CASE("the walls of the room stand where the plan has them") {
  const SensorInfo sensor = short_laser();
  OccupancyMap map(0.05, 30);
  for (double x = -1; x <= 1; x += 0.25) map.insert(see(furnished_room(), sensor, {x, 0, 0.1}), sensor, {x, 0, 0.1});
  int wall = 0, floor = 0;
  for (double x = -0.9; x < 1.0; x += 0.05) {
    wall += std::max(cell(map, x, -3.001), cell(map, x, -2.999)) > 150;
    floor += cell(map, x, 0.5) > 0 && cell(map, x, 0.5) < 60;
  }
  REQUIRE(wall >= 36);
  REQUIRE(floor >= 36);
}

TEST_CASE("a missing return says nothing, unless the sensor means free space by it") {
  SensorInfo sensor;
  sensor.range_max_m = 5.0;
  OccupancyMap map(0.1, 30);
  map.insert(one_beam(5.0f), sensor, {});
  map.insert(one_beam(0.0f), sensor, {});
  REQUIRE(rendered(map).empty());
  sensor.no_return_is_free = true;
  map.insert(one_beam(0.0f), sensor, {});
  REQUIRE(rendered(map).empty());  // zero is a fault, not a long way
  map.insert(one_beam(5.0f), sensor, {0.05, 0.05, 0});
  REQUIRE(cell(map, 4.5, 0.05) > 0);
  REQUIRE(cell(map, 4.5, 0.05) < 100);
}

TEST_CASE("beams beyond the limit are free up to it and end nowhere") {
  OccupancyMap map(0.1, 2.0);
  map.insert(one_beam(6.0f), SensorInfo(), {0.05, 0.05, 0});
  REQUIRE(cell(map, 1.5, 0.05) > 0);
  REQUIRE(cell(map, 2.05, 0.05) < 100);
  REQUIRE(cell(map, 3.0, 0.05) == 0);
}

TEST_CASE("only tiles that changed are named, once, also left of and below the origin") {
  OccupancyMap map(0.1, 30);
  map.insert(one_beam(1.0f), SensorInfo(), {-0.5, -0.5, kPi});
  const std::set<OccupancyMap::TileIndex> expected = {{-1, -1}};
  REQUIRE(map.take_changed() == expected);
  REQUIRE(map.take_changed().empty());
  map.insert(one_beam(1.0f), SensorInfo(), {-0.5, -0.5, kPi});
  REQUIRE(map.take_changed() == expected);
}

TEST_CASE("an empty scan changes nothing") {
  OccupancyMap map(0.1, 30);
  map.insert(Scan(), SensorInfo(), {});
  REQUIRE(map.tiles().empty());
}

TEST_CASE("after the graph has moved its nodes, the map is the one drawn there in the first place") {
  const SensorInfo sensor = short_laser();
  RandomStream random(132, RandomStreamId::kLaser);
  MapBuilder moved{MapBuilderConfig()}, placed{MapBuilderConfig()};
  for (NodeId id = 0; id < 12; ++id) {
    const Pose2 truth(0.2 * static_cast<double>(id) - 1.2, 0, 0.1 * static_cast<double>(id));
    const Scan scan = see(furnished_room(), sensor, truth, &random);
    moved.add_node(scan, sensor, truth * Pose2(0.3, 0.1, 0.05));
    moved.set_pose(id, truth);
    placed.add_node(scan, sensor, truth);
  }
  REQUIRE(rendered(moved.map()) != rendered(placed.map()));
  REQUIRE(moved.redraw(false) == 12);
  REQUIRE(rendered(moved.map()) == rendered(placed.map()));
  REQUIRE(moved.redraw(false) == 0);
}

TEST_CASE("small moves wait for the end of the run") {
  const SensorInfo sensor = short_laser();
  MapBuilder builder{MapBuilderConfig()};
  builder.add_node(see(furnished_room(), sensor, {}), sensor, {});
  builder.set_pose(0, {0.01, 0, 0});
  REQUIRE(builder.redraw(false) == 0);
  REQUIRE(builder.redraw(true) == 1);
  builder.clear();
  REQUIRE(builder.map().tiles().empty());
  REQUIRE(builder.redraw(true) == 0);
}
