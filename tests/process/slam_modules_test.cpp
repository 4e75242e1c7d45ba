// SPDX-License-Identifier: BSD-3-Clause
/// The modules of the core on the in-process bus: sensor messages in, what they make of them out.
#include <zlib.h>

#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <modslam/map_tile_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/modules.hpp"
#include "common/matching/verdict.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stage.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A robot in the furnished room that circles and says what its sensors see, on the bus.
struct Robot {
  explicit Robot(Stage& on) : stage(on), bus(on.bus("robot")) {
    sensor.T_base_laser = {0.1, 0, 0};
    bus.publish(channel::kSensorInfo, to_message(sensor, utime));
  }
  void step(const Pose2& motion = {0.1, 0, 2 * kPi / 63}) {
    if (moved) T_map_base = T_map_base * motion;
    if (moved) T_odom_base = T_odom_base * motion * Pose2(0.005, 0, 0.004);
    moved = true;
    utime += 200'000;
    bus.publish(channel::kOdometry, to_message(TimedPose{utime, T_odom_base, 0}));
    bus.publish(channel::kGroundTruth, to_message(TimedPose{utime, T_map_base, 0}));
    bus.publish(channel::kLaser, to_message(see(furnished_room(), sensor, T_map_base, &random, utime)));
    stage.drain(1);
  }
  Stage& stage;
  Bus& bus;
  SensorInfo sensor = short_laser();
  RandomStream random{161, RandomStreamId::kLaser};
  Pose2 T_map_base{0, -1, 0}, T_odom_base{20, 5, 1};
  std::int64_t utime = 1'000'000'000;
  bool moved = false;
};

/// A robot and the three modules that know where it is.
struct Mapping {
  explicit Mapping(const SystemConfig& config = {})
      : matcher(stage.host("scan_matcher", make_scan_matcher, config)), estimator(stage.host("graph_optimizer", make_graph_optimizer, config)),
        detector(stage.host("loop_detector", make_loop_detector, config)) {}
  void drive(int steps, const Pose2& motion = {0.1, 0, 2 * kPi / 63}) {
    for (int k = 0; k < steps; ++k) robot.step(motion);
  }
  /// Where the last POSE says that the robot is, in the frame of its true place.
  Pose2 believed() const { return start * to_pose(poses.back().T_map_base); }

  Stage stage;
  Module &matcher, &estimator, &detector;
  const std::vector<pose_estimate_t>& poses = stage.record<pose_estimate_t>(channel::kPose);
  const std::vector<graph_node_t>& nodes = stage.record<graph_node_t>(channel::kNode);
  const std::vector<graph_update_t>& updates = stage.record<graph_update_t>(channel::kGraph);
  Robot robot{stage};
  Pose2 start = robot.T_map_base;
};

}  // namespace

TEST_CASE("scan_matcher answers every scan once, numbered, with a verdict") {
  Stage stage;
  stage.host("scan_matcher", make_scan_matcher);
  const auto& matches = stage.record<scan_match_t>(channel::kScanMatch);
  Robot robot(stage);
  for (int k = 0; k < 20; ++k) robot.step();
  REQUIRE(matches.size() == 20);
  REQUIRE(matches[0].verdict == scan_match_t::FIRST);
  for (std::size_t k = 1; k < 20; ++k) {
    REQUIRE(matches[k].seq == static_cast<std::int64_t>(k));
    REQUIRE(matches[k].verdict == scan_match_t::OK);
    REQUIRE(matches[k].utime_from == matches[k - 1].utime);
    REQUIRE(matches[k].track == matches[0].track);
    REQUIRE_THAT(to_pose(matches[k].T_from_to), IsNear({0.1, 0, 2 * kPi / 63}, 0.012, 0.006));
  }
}

TEST_CASE("twelve rounds of the same room make no more nodes, edges or errors than four") {
  Mapping run;
  const auto edges = [&] {
    std::size_t count = 0;
    for (const graph_update_t& update : run.updates)
      if (!update.snapshot) count += update.edges.size();
    return count;
  };
  std::size_t nodes_at_four = 0, edges_at_four = 0;
  std::vector<double> worst_m;  // of each round
  for (int round = 0; round < 12; ++round) {
    worst_m.push_back(0);
    for (int k = 0; k < 63; ++k) {
      run.drive(1);
      worst_m.back() = std::max(worst_m.back(), distance(run.believed(), run.robot.T_map_base));
    }
    if (round == 3) nodes_at_four = run.nodes.size(), edges_at_four = edges();
  }
  INFO(nodes_at_four << " nodes, " << edges_at_four << " edges after four rounds, " << run.nodes.size() << ", " << edges() << " after twelve");
  CHECK(nodes_at_four > 15);
  CHECK(run.nodes.size() <= nodes_at_four + 2);
  CHECK(edges() <= edges_at_four + 6);
  CHECK(run.poses.size() == 12 * 63);
  CHECK(*std::max_element(worst_m.begin() + 4, worst_m.end()) < std::max(0.03, worst_m[0] + 0.01));
}

TEST_CASE("a robot that is carried to another corner of the room is lost, says so, and finds back") {
  Mapping run;
  run.drive(100);
  run.robot.T_map_base = {-2.8, 0.9, -1.2};
  run.drive(10, {0, 0, 0});  // the wheels hung in the air
  run.drive(4, {0.08, 0, -0.01});
  REQUIRE(run.estimator.words().find("lost: apart from the map") != std::string::npos);
  REQUIRE(run.poses.back().verdict == scan_match_t::AMBIGUOUS);
  for (int k = 0; k < 250 && run.poses.back().verdict == scan_match_t::AMBIGUOUS; ++k) run.drive(1);
  CHECK(run.estimator.words().find("lost:") == std::string::npos);
  CHECK_THAT(run.believed(), IsNear(run.robot.T_map_base, 0.05, 0.02));
}

TEST_CASE("a robot that recognises nothing while it drives on is not carried away: its wheels still tell the way") {
  Mapping run;
  run.drive(100);
  run.robot.T_map_base = {-2.8, 0.9, -1.2};
  run.drive(12, {0.08, 0, -0.01});
  CHECK(run.estimator.words().find("lost:") == std::string::npos);
  CHECK(run.poses.back().verdict != scan_match_t::AMBIGUOUS);
}

TEST_CASE("asked to polish in the middle of a drive, the estimator moves nodes, and drives on") {
  Mapping run;
  run.drive(80);
  const std::size_t updates_before = run.updates.size();
  REQUIRE(run.estimator.command("polish"));
  run.stage.drain(1);
  REQUIRE(run.updates.size() > updates_before);
  REQUIRE_FALSE(run.updates.back().poses.empty());
  REQUIRE_FALSE(run.estimator.command("dance"));
  run.drive(40);
  REQUIRE(run.poses.size() == 120);
  CHECK_THAT(run.believed(), IsNear(run.robot.T_map_base, 0.03, 0.02));
}

TEST_CASE("the chain of matcher, estimator and loop detector knows where it is after two rounds") {
  SystemConfig config;
  config.graph_optimizer.full_at = 0;  // or the second round would need no loops
  Mapping run(config);
  const auto& loops = run.stage.record<loop_closure_t>(channel::kLoop);
  run.drive(150);
  REQUIRE(run.poses.size() == 150);
  REQUIRE(run.nodes.size() >= 35);
  for (std::size_t k = 0; k < run.nodes.size(); ++k) REQUIRE(run.nodes[k].id == static_cast<std::int64_t>(k));
  REQUIRE(std::count_if(loops.begin(), loops.end(), [](const loop_closure_t& m) { return m.verdict == scan_match_t::OK; }) >= 3);
  REQUIRE_THAT(run.believed(), IsNear(run.robot.T_map_base, 0.02, 0.01));
}

TEST_CASE("the estimator bridges lost matches with the matcher's own track") {
  Stage stage;
  Stage hidden;  // the matcher hears and speaks on a bus of its own; the test carries its words across
  hidden.host("scan_matcher", make_scan_matcher);
  stage.host("graph_optimizer", make_graph_optimizer);
  const auto& poses = stage.record<pose_estimate_t>(channel::kPose);
  int number = 0;
  hidden.transport.subscribe(channel::kScanMatch, [&](const std::string& name, const void* bytes, int size) {
    if (++number % 4 != 0) stage.transport.publish(name, bytes, size);  // every fourth is lost
  });
  for (const char* name : {channel::kLaser, channel::kOdometry, channel::kSensorInfo})
    stage.transport.subscribe(name, [&](const std::string& c, const void* bytes, int size) { hidden.transport.publish(c, bytes, size); });
  Robot robot(stage);
  const Pose2 start = robot.T_map_base;
  for (int k = 0; k < 61; ++k) {
    robot.step();
    hidden.drain(1);
    stage.drain(1);
  }
  REQUIRE(poses.size() == 46);
  REQUIRE_THAT(start * to_pose(poses.back().T_map_base), IsNear(robot.T_map_base, 0.03, 0.01));
}

TEST_CASE("the yardsticks follow exactly what they are told to believe") {
  for (const bool truth : {false, true}) {
    Stage stage;
    SystemConfig config;
    config.launch.estimator = truth ? "ground_truth" : "odometry";
    stage.host("yardstick", make_yardstick, config);
    const auto& poses = stage.record<pose_estimate_t>(channel::kPose);
    Robot robot(stage);
    const Pose2 start = truth ? robot.T_map_base : robot.T_odom_base;
    for (int k = 0; k < 40; ++k) robot.step();
    REQUIRE(poses.size() == 40);
    REQUIRE_THAT(start * to_pose(poses.back().T_map_base), IsNear(truth ? robot.T_map_base : robot.T_odom_base, 1e-4, 1e-4));
  }
}

TEST_CASE("map_builder publishes tiles that unpack, only changed ones, all of them when somebody joins") {
  Stage stage;
  SystemConfig config;
  config.launch.estimator = "ground_truth";
  stage.host("yardstick", make_yardstick, config);
  Module& builder = stage.host("map_builder", make_map_builder, config);
  const auto& tiles = stage.record<map_tile_t>(channel::kMapTile);
  Robot robot(stage);
  for (int k = 0; k < 60; ++k) robot.step();
  builder.finish();
  stage.drain();
  REQUIRE_FALSE(tiles.empty());
  std::set<std::pair<int, int>> places;
  int walls = 0, floor = 0;
  for (const map_tile_t& tile : tiles) {
    places.emplace(tile.tile_x, tile.tile_y);
    std::vector<std::uint8_t> cells(static_cast<std::size_t>(tile.ncells * tile.ncells));
    uLongf size = cells.size();
    REQUIRE(uncompress(cells.data(), &size, tile.data.data(), tile.data.size()) == Z_OK);
    REQUIRE(size == cells.size());
    for (const std::uint8_t c : cells) {
      walls += c > 160;
      floor += c > 0 && c < 60;
    }
  }
  REQUIRE(walls > 300);
  REQUIRE(floor > 3000);
  const std::size_t before = tiles.size();
  stage.drain();
  REQUIRE(tiles.size() == before);  // nothing changed
  sync_request_t request{};
  request.requester = "latecomer";
  robot.bus.publish(channel::kSyncRequest, request);
  stage.drain();  // the robot stands still
  std::set<std::pair<int, int>> again;
  for (std::size_t k = before; k < tiles.size(); ++k) again.emplace(tiles[k].tile_x, tiles[k].tile_y);
  REQUIRE(std::includes(again.begin(), again.end(), places.begin(), places.end()));
}

TEST_CASE("garbage on every channel stops no module") {
  Stage stage;
  stage.host("scan_matcher", make_scan_matcher);
  stage.host("graph_optimizer", make_graph_optimizer);
  stage.host("loop_detector", make_loop_detector);
  stage.host("map_builder", make_map_builder);
  const auto& poses = stage.record<pose_estimate_t>(channel::kPose);
  Robot robot(stage);
  RandomStream random(162, RandomStreamId::kIns);
  const char* channels[] = {channel::kLaser, channel::kSensorInfo, channel::kOdometry, channel::kIns,  channel::kScanMatch,
                            channel::kNode,  channel::kGraph,      channel::kLoop,     channel::kPose, channel::kSyncRequest};
  for (int k = 0; k < 30; ++k) {
    robot.step();
    for (const char* name : channels) {
      std::string noise(static_cast<std::size_t>(random.uniform(0, 200)), ' ');
      for (char& c : noise) c = static_cast<char>(random.uniform(0, 256));
      stage.transport.publish(name, noise.data(), static_cast<int>(noise.size()));
    }
    stage.drain(1);
  }
  REQUIRE(poses.size() == 30);
}

TEST_CASE("a LOOP about nodes that are not there, or with numbers that are none, is refused and the estimator goes on") {
  Stage stage;
  stage.host("scan_matcher", make_scan_matcher);
  Module& estimator = stage.host("graph_optimizer", make_graph_optimizer);
  const auto& poses = stage.record<pose_estimate_t>(channel::kPose);
  Robot robot(stage);
  for (int k = 0; k < 20; ++k) robot.step();
  loop_closure_t loop{};
  loop.verdict = scan_match_t::OK;
  loop.from_node = 0;
  loop.to_node = 1'000'000;
  robot.bus.publish(channel::kLoop, loop);
  loop.from_node = -3;
  loop.to_node = 1;
  robot.bus.publish(channel::kLoop, loop);
  loop.from_node = 0;
  loop.T_from_to[0] = std::nan("");
  robot.bus.publish(channel::kLoop, loop);
  robot.step();
  REQUIRE(poses.size() == 21);
  REQUIRE_THAT(estimator.words(), Catch::Matchers::Contains("2 refused"));
}
