// SPDX-License-Identifier: BSD-3-Clause
/// semantics-bench: what the semantic map costs, against the size of the building. CPU milliseconds on one core.
///
/// Buildings of 10 to 400 rooms of 4 x 5 m along corridors; the laser looks from two places in each room and from the corridor before it.
/// Driven once, a room has two or three nodes; driven ten times, each time beside the places of the times before, it has 25, less than in our own runs
/// (Apartment: 519 nodes, 14 rooms; intel: 1582).
/// insert: a scan put in. update: the map after each of the last nodes came, and after a loop moved a tenth of all. render: all of it at once.
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

constexpr double kWide_m = 4, kDeep_m = 5, kCorridor_m = 2, kDoor_m = 0.9, kSight_m = 12;
constexpr std::size_t kUpdates = 101;
constexpr int kAlong = 10;  // rooms on one side of a corridor

struct Building {
  Plan plan;
  std::vector<Pose2> places;
};

/// One corridor with rooms on both sides; `y` is its middle.
void add_corridor(Building& building, double y, int rooms_each_side) {
  const double length_m = rooms_each_side * kWide_m;
  for (const double side : {-1.0, 1.0}) {
    const double near = y + side * kCorridor_m / 2, far = near + side * kDeep_m;
    building.plan.push_back({{0, far}, {length_m, far}});
    for (int k = 0; k <= rooms_each_side; ++k) building.plan.push_back({{k * kWide_m, near}, {k * kWide_m, far}});
    for (int k = 0; k < rooms_each_side; ++k) {
      const double door = k * kWide_m + 1.2;
      building.plan.push_back({{k * kWide_m, near}, {door, near}});
      building.plan.push_back({{door + kDoor_m, near}, {(k + 1) * kWide_m, near}});
    }
  }
  for (const double x : {0.0, length_m}) building.plan.push_back({{x, y - kCorridor_m / 2}, {x, y + kCorridor_m / 2}});
  for (int k = 0; k < rooms_each_side; ++k) {
    const double x = k * kWide_m;
    building.places.emplace_back(x + 1.6, y, 0.3 * k);
    for (const double side : {-1.0, 1.0}) {
      building.places.emplace_back(x + 1.4, y + side * 2.5, 0.7 * k);
      building.places.emplace_back(x + 2.8, y + side * 4.5, 1.1 * k);
    }
  }
}

/// @param drives  how often each place is passed.
Building building_of(int rooms, int drives) {
  Building building;
  for (int row = 0; rooms > 0; ++row, rooms -= 2 * kAlong) add_corridor(building, row * (kCorridor_m + 2 * kDeep_m + 0.3), std::min(kAlong, rooms / 2));
  const std::vector<Pose2> once = building.places;
  for (int drive = 1; drive < drives; ++drive)
    for (const Pose2& place : once) building.places.emplace_back(place.x + 0.5 * std::cos(2.4 * drive), place.y + 0.25 * std::sin(2.4 * drive), place.heading + drive);
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

nlohmann::ordered_json measure(int rooms, int drives) {
  const Building building = building_of(rooms, drives);
  const SensorInfo sensor = short_laser();
  RandomStream random(41, RandomStreamId::kLaser);
  SemanticMapper mapper{SemanticsConfig()};
  std::vector<double> insert_ms, update_ms;
  const std::size_t nodes = building.places.size();
  for (std::size_t k = 0; k < nodes; ++k) {
    const Pose2& place = building.places[k];
    const Scan scan = see(near(building.plan, place.translation()), sensor, place, &random);
    insert_ms.push_back(timed([&] { mapper.add_node(scan, sensor, place); }));
    if (k + kUpdates < nodes) continue;
    const double ms = timed([&] { mapper.update(false); });
    if (k + kUpdates > nodes || k == 0) update_ms.push_back(ms);  // the first one sees all that came before
  }
  for (std::size_t k = 0; k < nodes / 10; ++k) {
    Pose2 moved = building.places[k];
    moved.x += 0.05;
    mapper.set_pose(static_cast<NodeId>(k), moved);
  }
  const double loop_ms = timed([&] { mapper.update(false); });
  SemanticLayers layers;
  const double render_ms = timed([&] { layers = mapper.render(); });
  return {{"rooms", rooms}, {"found_rooms", layers.rooms.size()}, {"nodes", nodes}, {"insert_ms", shares(insert_ms)}, {"update_ms", shares(update_ms)},
          {"after_loop_ms", loop_ms}, {"render_ms", render_ms}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What the semantic map costs, against the size of the building.");
  std::string json;
  std::vector<int> sizes = {10, 50, 100, 200, 400}, often = {40};
  app.add_option("--json", json, "file for the figures");
  app.add_option("--rooms", sizes, "sizes of the buildings")->delimiter(',');
  app.add_option("--often", often, "sizes of buildings driven ten times")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);  // as the process does
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  const auto add = [&](int rooms, int drives) {
    all.push_back(measure(rooms, drives));
    std::printf("%s\n", all.back().dump().c_str());
    std::fflush(stdout);
  };
  for (const int rooms : sizes) add(rooms, 1);
  for (const int rooms : often) add(rooms, 10);
  if (!json.empty()) std::ofstream(json) << all.dump(1) << '\n';
}
