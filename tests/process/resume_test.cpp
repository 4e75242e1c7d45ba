// SPDX-License-Identifier: BSD-3-Clause
/// Modules that are killed and made anew with the journals of their earlier lives.
#include <catch2/catch.hpp>
#include <filesystem>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <modslam/loop_search_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stage.hpp"
#include "tests/support/synthetic_scan.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// One sensor message after the other of a robot that circles in the furnished room.
struct Robot {
  void step(Stage& stage) {
    Bus& bus = stage.bus("robot");
    if (utime == 1'000'000'000) bus.publish(channel::kSensorInfo, to_message(sensor, utime));
    const Pose2 motion{0.1, 0, 2 * kPi / 63};
    T_map_base = T_map_base * motion;
    T_odom_base = T_odom_base * motion * Pose2(0.005, 0, 0.004);
    utime += 200'000;
    bus.publish(channel::kOdometry, to_message(TimedPose{utime, T_odom_base, 0}));
    bus.publish(channel::kLaser, to_message(see(furnished_room(), sensor, T_map_base, &random, utime)));
    stage.drain(3);
  }
  SensorInfo sensor = short_laser();
  RandomStream random{171, RandomStreamId::kLaser};
  Pose2 T_map_base{0, -1, 0}, T_odom_base{20, 5, 1};
  std::int64_t utime = 1'000'000'000;
};

struct Outcome {
  std::vector<pose_estimate_t> poses;
  std::vector<graph_node_t> nodes;
  std::vector<loop_closure_t> loops;
};

/// 150 steps; all three modules die after each `life_steps` of them.
Outcome drive(int life_steps, const std::string& journals) {
  SystemConfig config;
  config.journal.folder = journals;
  Robot robot;
  Outcome outcome;
  for (int done = 0; done < 150; done += life_steps) {
    Stage stage;
    stage.host("scan_matcher", make_scan_matcher, config);
    stage.host("graph_optimizer", make_graph_optimizer, config);
    stage.host("loop_detector", make_loop_detector, config);
    stage.drain();  // a detector that is born asks for the graph
    const auto& poses = stage.record<pose_estimate_t>(channel::kPose);
    const auto& nodes = stage.record<graph_node_t>(channel::kNode);
    const auto& loops = stage.record<loop_closure_t>(channel::kLoop);
    for (int k = 0; k < std::min(life_steps, 150 - done); ++k) robot.step(stage);
    outcome.poses.insert(outcome.poses.end(), poses.begin(), poses.end());
    outcome.nodes.insert(outcome.nodes.end(), nodes.begin(), nodes.end());
    outcome.loops.insert(outcome.loops.end(), loops.begin(), loops.end());
  }
  return outcome;
}

}  // namespace

TEST_CASE("matcher, estimator and loop detector that die every 17 scans say what they would have said") {
  const TemporaryFolder folder;
  const Outcome calm = drive(150, ""), wild = drive(17, folder.path);
  REQUIRE(calm.loops.size() >= 3);
  REQUIRE(wild.poses.size() == calm.poses.size());
  REQUIRE(wild.nodes.size() == calm.nodes.size());
  REQUIRE(wild.loops.size() == calm.loops.size());
  for (std::size_t k = 0; k < calm.nodes.size(); ++k) {
    REQUIRE(wild.nodes[k].id == static_cast<std::int64_t>(k));
    REQUIRE(wild.nodes[k].utime == calm.nodes[k].utime);
  }
  for (std::size_t k = 0; k < calm.poses.size(); ++k) {
    REQUIRE(wild.poses[k].utime == calm.poses[k].utime);
    // Moves of less than 2 mm are not published, so the journal does not know them.
    REQUIRE_THAT(to_pose(wild.poses[k].T_map_base), IsNear(to_pose(calm.poses[k].T_map_base), 0.004, 0.002));
  }
}

TEST_CASE("an estimator whose journal lost a node begins anew and says why") {
  const TemporaryFolder folder;
  drive(150, folder.path);
  const std::string path = folder.path + "/graph_optimizer.journal";
  std::vector<LogEvent> records;
  {
    LogReader reader(path);
    for (LogEvent record; reader.next(record);) records.push_back(record);
  }
  std::filesystem::remove(path);
  LogWriter writer(path, LogWriter::kAppend);
  bool dropped = false;
  for (const LogEvent& record : records) {
    if (!dropped && record.channel == channel::kNode) {
      dropped = true;
      continue;
    }
    writer.write(record.utime, record.channel, record.bytes.data(), static_cast<int>(record.bytes.size()));
  }
  writer.close();
  SystemConfig config;
  config.journal.folder = folder.path;
  Stage stage;
  Module& estimator = stage.host("graph_optimizer", make_graph_optimizer, config);
  REQUIRE_THAT(estimator.words(), Catch::Matchers::Contains("node 0 is not in it"));
  REQUIRE_FALSE(estimator.resumption());
}

TEST_CASE("a match that comes twice or late moves the robot once, and a loop that is said twice does not confirm itself") {
  Stage stage, other;
  other.host("scan_matcher", make_scan_matcher);
  Module& estimator = stage.host("graph_optimizer", make_graph_optimizer);
  const auto& poses = stage.record<pose_estimate_t>(channel::kPose);
  const auto& matches = other.record<scan_match_t>(channel::kScanMatch);
  Robot robot;
  for (int k = 0; k < 20; ++k) robot.step(other);
  Bus& bus = stage.bus("matcher");
  for (std::size_t k = 0; k < matches.size(); ++k) {
    bus.publish(channel::kScanMatch, matches[k]);
    bus.publish(channel::kScanMatch, matches[k / 2]);  // an old one
    bus.publish(channel::kScanMatch, matches[k]);
  }
  stage.drain();
  REQUIRE(poses.size() == 20);
  loop_closure_t loop{};
  loop.verdict = scan_match_t::OK;
  loop.from_node = 0;
  loop.to_node = 5;
  loop.T_from_to[0] = 3;  // disagrees with the graph: waits for others
  for (double* diagonal : {&loop.information[0], &loop.information[3], &loop.information[5]}) *diagonal = 1e4;
  for (int k = 0; k < 6; ++k) bus.publish(channel::kLoop, loop);
  stage.drain();
  REQUIRE_THAT(estimator.words(), Catch::Matchers::Contains("0 loops accepted"));
}

TEST_CASE("in lockstep the estimator takes no match before the newest node was searched, and gives up waiting after two seconds") {
  SystemConfig config;
  config.launch.lockstep = true;
  Stage stage;
  stage.host("scan_matcher", make_scan_matcher, config);
  Module& estimator = stage.host("graph_optimizer", make_graph_optimizer, config);
  const auto& poses = stage.record<pose_estimate_t>(channel::kPose);
  Robot robot;
  for (int k = 0; k < 5; ++k) robot.step(stage);
  const std::size_t freed = poses.size();
  REQUIRE(freed > 1);  // the first node has nobody to be compared with
  REQUIRE(freed < 5);  // up to the next node
  REQUIRE_FALSE(estimator.complete());
  estimator.tick(1'000'000);
  estimator.tick(1'900'000);
  stage.transport.poll(0);
  REQUIRE(poses.size() == freed);
  estimator.tick(2'000'001);
  stage.drain();
  REQUIRE(poses.size() == 5);
  REQUIRE(estimator.complete());
}

TEST_CASE("in lockstep the word that the newest node was searched frees the matches that wait") {
  SystemConfig config;
  config.launch.lockstep = true;
  Stage stage;
  stage.host("scan_matcher", make_scan_matcher, config);
  stage.host("graph_optimizer", make_graph_optimizer, config);
  const auto& poses = stage.record<pose_estimate_t>(channel::kPose);
  Robot robot;
  for (int k = 0; k < 5; ++k) robot.step(stage);
  const std::size_t freed = poses.size();
  REQUIRE(freed < 5);
  loop_search_t searched{};
  searched.node = 1;
  stage.bus("detector").publish(channel::kLoopSearch, searched);
  stage.drain();
  REQUIRE(poses.size() > freed);
}

TEST_CASE("a recorder that is made anew writes on and asks for the nodes behind what it has") {
  const TemporaryFolder folder;
  SystemConfig config;
  config.recorder.path = folder.path + "/run.lcm";
  Robot robot;
  std::size_t nodes = 0;
  {
    Stage stage;
    stage.host("scan_matcher", make_scan_matcher, config);
    stage.host("graph_optimizer", make_graph_optimizer, config);
    stage.host("recorder", make_recorder, config);
    const auto& said = stage.record<graph_node_t>(channel::kNode);
    for (int k = 0; k < 30; ++k) robot.step(stage);
    nodes = said.size();
  }
  REQUIRE(nodes > 5);
  Stage stage;
  Module& recorder = stage.host("recorder", make_recorder, config);
  const auto& requests = stage.record<sync_request_t>(channel::kSyncRequest);
  recorder.tick(1'000'000);
  stage.drain(1);
  REQUIRE(requests.size() == 1);
  REQUIRE(requests[0].from_node == static_cast<std::int64_t>(nodes));
  REQUIRE_FALSE(recorder.complete());
  graph_update_t snapshot{};
  snapshot.snapshot = 1;
  snapshot.nchunks = 1;
  stage.bus("estimator").publish(channel::kGraph, snapshot);
  stage.drain(1);
  REQUIRE(recorder.complete());
  LogReader reader(config.recorder.path);
  std::size_t laser = 0, graphs = 0;
  for (LogEvent event; reader.next(event);) {
    laser += event.channel == channel::kLaser;
    graphs += event.channel == channel::kGraph;
  }
  REQUIRE(laser == 30);
  REQUIRE(graphs > 5);
  REQUIRE(reader.damage().empty());
}
