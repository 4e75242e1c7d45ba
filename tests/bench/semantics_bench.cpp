// SPDX-License-Identifier: BSD-3-Clause
/// semantics-bench: what the semantic map costs, against the size of the building. CPU milliseconds on one core.
///
/// Buildings of 10 to 1600 rooms of 4 x 5 m, ten along each corridor, with walls of 0.2 m and open doors; the laser looks from two places in each room and from the corridor before it.
/// Driven once, a room has two or three nodes; driven ten times, each time beside the places of the times before, it has 25, less than in our own runs
/// (Apartment: 519 nodes, 14 rooms; intel: 1582).
/// Buildings stand along the raster, or by 45 degrees askew.
/// All corridors are alike, to the noise of the scans and the cells they fall in, so that buildings differ in nothing but their size:
/// insert: a scan put in. update: the map after each of the last nodes came; of buildings of 60 rooms and more, these are the same four corridors.
/// again: the same while the last corridor is driven four times more; the same in every building, but for what the map knows beyond it.
/// after_loop: after a loop moved a tenth of all. render: all of it at once.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "common/semantics/semantic_mapper.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

constexpr double kWide_m = 4, kDeep_m = 5, kCorridor_m = 2, kDoor_m = 0.9, kThick_m = 0.2, kSight_m = 12;
constexpr double kRow_m = 12.8, kColumn_m = 22.4;  // from corridor to corridor; multiples of the tiles that maps are kept in
constexpr std::size_t kUpdates = 101;
constexpr int kAlong = 5;  // rooms on one side of a corridor
constexpr int kAgain = 4;

struct Building {
  Plan plan;
  std::vector<Pose2> places;
};

/// One corridor with rooms on both sides; it begins at `from`. Walls have two faces, doors have jambs.
void add_corridor(Building& building, const Eigen::Vector2d& from) {
  const double length_m = kAlong * kWide_m;
  const auto face = [&](double ax, double ay, double bx, double by) { building.plan.push_back({from + Eigen::Vector2d(ax, ay), from + Eigen::Vector2d(bx, by)}); };
  for (const double side : {-1.0, 1.0}) {
    const double inner = side * (kCorridor_m / 2 - kThick_m / 2), near = side * (kCorridor_m / 2 + kThick_m / 2), far = side * (kCorridor_m / 2 + kDeep_m - kThick_m / 2);
    double from_x = kThick_m / 2;
    for (int k = 0; k < kAlong; ++k) {
      const double left = k * kWide_m + kThick_m / 2, right = (k + 1) * kWide_m - kThick_m / 2, door = k * kWide_m + 1.2, beyond = door + kDoor_m;
      face(left, far, right, far);
      for (const double x : {left, right}) face(x, near, x, far);
      face(left, near, door, near);
      face(beyond, near, right, near);
      for (const double x : {door, beyond}) face(x, inner, x, near);
      face(from_x, inner, door, inner);
      from_x = beyond;
    }
    face(from_x, inner, length_m - kThick_m / 2, inner);
  }
  for (const double x : {kThick_m / 2, length_m - kThick_m / 2}) face(x, -(kCorridor_m - kThick_m) / 2, x, (kCorridor_m - kThick_m) / 2);
  for (int k = 0; k < kAlong; ++k) {
    const double x = from.x() + k * kWide_m;
    building.places.emplace_back(x + 1.6, from.y(), 0.3 * k);
    for (const double side : {-1.0, 1.0}) {
      building.places.emplace_back(x + 1.4, from.y() + side * 2.5, 0.7 * k);
      building.places.emplace_back(x + 2.8, from.y() + side * 4.5, 0.7 * k + 3);
    }
  }
}

/// The `drive`th time, from 0, a place is passed a little beside it.
Pose2 beside(const Pose2& place, int drive) {
  return drive == 0 ? place : Pose2(place.x + 0.5 * std::cos(2.4 * drive), place.y + 0.25 * std::sin(2.4 * drive), place.heading + drive);
}

/// @param drives  how often each place is passed.
Building building_of(int rooms, int drives, double turned_rad) {
  Building building;
  for (int corridor = 0; corridor * 2 * kAlong < rooms; ++corridor) add_corridor(building, {corridor % 2 * kColumn_m, corridor / 2 * kRow_m});
  const Pose2 T_map_plan(0, 0, turned_rad);
  for (test::Wall& wall : building.plan) wall = {T_map_plan * wall.a, T_map_plan * wall.b};
  for (Pose2& place : building.places) place = T_map_plan * place;
  const std::vector<Pose2> once = building.places;
  for (int drive = 1; drive < drives; ++drive)
    for (const Pose2& place : once) building.places.push_back(beside(place, drive));
  return building;
}

Plan near(const Plan& plan, const Eigen::Vector2d& eye) {
  Plan out;
  for (const test::Wall& wall : plan) {
    const Eigen::Vector2d d = wall.b - wall.a;
    const double t = std::clamp(d.dot(eye - wall.a) / d.squaredNorm(), 0.0, 1.0);
    if ((wall.a + t * d - eye).norm() < kSight_m) out.push_back(wall);
  }
  return out;
}

double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <class Work>
double timed(Work work) {
  const double begin = cpu_ms();
  work();
  return cpu_ms() - begin;
}

nlohmann::ordered_json shares(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  const auto at = [&](double share) { return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))]; };
  return {{"median", at(0.5)}, {"p95", at(0.95)}, {"max", ms.back()}};
}

nlohmann::ordered_json measure(int rooms, int drives, double turned_rad) {
  const Building building = building_of(rooms, drives, turned_rad);
  const SensorInfo sensor = short_laser();
  const std::size_t nodes = building.places.size(), in_corridor = std::min(nodes, std::size_t{5 * kAlong});
  SemanticMapper mapper{SemanticsConfig()};
  RandomStream random(0, RandomStreamId::kLaser);
  std::vector<double> insert_ms;
  const auto pass = [&](const Pose2& place) {
    const Scan scan = see(near(building.plan, place.translation()), sensor, place, &random);
    insert_ms.push_back(timed([&] { mapper.add_node(scan, sensor, place); }));
  };
  const auto update = [&] { return timed([&] { mapper.update(false); }); };

  std::vector<double> update_ms;
  for (std::size_t k = 0; k < nodes; ++k) {
    if (k % in_corridor == 0) random = RandomStream(41, RandomStreamId::kLaser);
    pass(building.places[k]);
    if (k + kUpdates < nodes) continue;
    const double ms = update();
    if (k + kUpdates > nodes || k == 0) update_ms.push_back(ms);  // the first one sees all that came before
  }
  for (std::size_t k = 0; k < nodes / 10; ++k) {
    Pose2 moved = building.places[k];
    moved.x += 0.05;
    mapper.set_pose(static_cast<NodeId>(k), moved);
  }
  const double loop_ms = update();
  SemanticLayers layers;
  const double render_ms = timed([&] { layers = mapper.render(); });
  std::vector<double> again_ms;
  for (int drive = 1; drive <= kAgain; ++drive)
    for (std::size_t k = nodes - in_corridor; k < nodes; ++k) {
      pass(beside(building.places[k], drives + drive));
      again_ms.push_back(update());
    }
  return {{"rooms", rooms}, {"turned_deg", turned_rad * 180 / kPi}, {"found_rooms", layers.rooms.size()}, {"nodes", nodes}, {"insert_ms", shares(insert_ms)}, {"update_ms", shares(update_ms)},
          {"again_ms", shares(again_ms)}, {"after_loop_ms", loop_ms}, {"render_ms", render_ms}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What the semantic map costs, against the size of the building.");
  std::string json;
  std::vector<int> sizes = {10, 60, 100, 200, 400, 1600}, often = {40}, turned = {60, 400};
  app.add_option("--json", json, "file for the figures");
  app.add_option("--rooms", sizes, "sizes of the buildings")->delimiter(',');
  app.add_option("--often", often, "sizes of buildings driven ten times")->delimiter(',');
  app.add_option("--turned", turned, "sizes of buildings that stand askew, by 45 degrees")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);  // as the process does
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  const auto add = [&](int rooms, int drives, double turned_rad) {
    all.push_back(measure(rooms, drives, turned_rad));
    std::printf("%s\n", all.back().dump().c_str());
    std::fflush(stdout);
  };
  for (const int rooms : sizes) add(rooms, 1, 0);
  for (const int rooms : often) add(rooms, 10, 0);
  for (const int rooms : turned) add(rooms, 1, kPi / 4);
  if (!json.empty()) std::ofstream(json) << all.dump(1) << '\n';
}
