// SPDX-License-Identifier: BSD-3-Clause
/// The simulated sensors on the in-process bus: what they say of states that are good, late, bad or missing.
#include <algorithm>
#include <limits>
#include <random>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/simulation_messages.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/simulation_stage.hpp"

namespace modslam {
namespace {

using namespace test;

TEST_CASE("more odometry noise changes odometry and nothing else") {
  SystemConfig config = apartment();
  Messages official = batch(config, 2000);
  config.odometry.noise = "raised";
  Messages raised = batch(config, 2000);
  CHECK(official["ODOMETRY"] != raised["ODOMETRY"]);
  for (const char* channel : {"LASER", "INS", "GROUND_TRUTH", "SIM_STATE"}) {
    INFO(channel);
    CHECK(official[channel].size() > 50);
    CHECK(official[channel] == raised[channel]);
  }
}

TEST_CASE("bad SIM_STATEs are refused and counted by each sensor, and none of them answers") {
  SimulationStage stage(apartment(), false);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const sim_state_t good = to_message(SimulationState{});
  std::vector<sim_state_t> bad(6, good);
  bad[0].T_world_base[0] = nan;
  bad[1].wheel_distance_m = nan;
  bad[2].wheel_turn_rad = std::numeric_limits<double>::infinity();
  bad[3].step = -5;
  bad[4].utime += 1;
  bad[5].yaw_rate = 1e9;
  Bus sender(stage.transport, "sender");
  for (const sim_state_t& message : bad) sender.publish(channel::kSimState, message);
  stage.transport.publish(channel::kSimState, "torn", 4);
  stage.settle();
  for (const auto& bus : stage.buses()) CHECK(bus->inputs().at(channel::kSimState).bad == 7);
  CHECK(stage.messages.size() == 1);  // SIM_STATE alone
  sender.publish(channel::kSimState, good);
  stage.settle();
  CHECK(stage.messages.count(channel::kLaser) == 1);
}

TEST_CASE("a state that comes late is refused, a repeated one passed over, and neither resets a sensor") {
  SystemConfig config = apartment();
  Messages expected = batch(config, 1200);
  SimulationStage stage(config, false);
  const auto& states = expected.at("SIM_STATE");
  const auto send = [&](std::size_t step) {
    stage.transport.publish(channel::kSimState, states[step].data(), static_cast<int>(states[step].size()));
    stage.settle();
  };
  for (std::size_t k = 0; k < states.size(); ++k) {
    send(k);
    if (k == 700 || k == 801) send(k - 100);
    if (k == 900) send(k);
  }
  for (const char* channel : {"ODOMETRY", "INS", "LASER", "SENSOR_INFO"}) {
    INFO(channel);
    CHECK(stage.messages[channel] == expected.at(channel));
  }
  for (const auto& bus : stage.buses()) {
    CHECK(bus->inputs().at(channel::kSimState).bad == 2);
    CHECK(bus->inputs().at(channel::kSimState).gaps == 0);
  }
}

TEST_CASE("odometry loses nothing but time when states are lost") {
  SystemConfig config = apartment();
  config.odometry.noise = "none";
  const Messages all = batch(config, 4000);
  SimulationStage lossy(config, false);
  std::mt19937_64 random(5);
  Pose2 T_world_start, T_world_last;
  for (const std::string& bytes : all.at("SIM_STATE")) {
    const auto state = to_simulation_state(decoded<sim_state_t>(bytes));
    if (state.step == 0) T_world_start = state.T_world_base;
    if (state.step > 0 && state.step % 5 != 0 && random() % 2) continue;
    if (state.step % 500 == 250) continue;  // one that was due
    lossy.transport.publish(channel::kSimState, bytes.data(), static_cast<int>(bytes.size()));
    lossy.settle();
    if (state.step % 5 == 0) T_world_last = state.T_world_base;
  }
  const auto last = to_timed_pose(decoded<bot_core::pose_t>(lossy.messages["ODOMETRY"].back()));
  CHECK_THAT(T_world_start * last.pose, IsNear(T_world_last, 0.005, 0.005));
  CHECK(lossy.buses()[0]->inputs().at(channel::kSimState).gaps > 1000);
  CHECK(lossy.messages["LASER"] == all.at("LASER"));  // the noise of a sweep is that sweep's own
}

TEST_CASE("points of an exact laser, placed with the truth and the mount, lie on obstacles") {
  SystemConfig config = apartment();
  config.laser.noise = "none";
  config.laser.dropout = 0;
  config.laser.mount_y_m = -0.1;
  config.laser.mount_yaw_rad = 0.5;
  Messages run = batch(config, 3000);
  const SensorInfo sensor = to_sensor_info(decoded<sensor_info_t>(run["SENSOR_INFO"].front()));
  const Obstacles obstacles(load_world(config.simulator.world));
  std::map<std::int64_t, Pose2> truth;
  for (const std::string& bytes : run["GROUND_TRUTH"]) {
    const TimedPose pose = to_timed_pose(decoded<bot_core::pose_t>(bytes));
    truth[pose.utime] = pose.pose;
  }
  std::size_t points = 0;
  for (const std::string& bytes : run["LASER"]) {
    const Scan scan = to_scan(decoded<bot_core::planar_lidar_t>(bytes));
    for (const ScanPoint& point : points_base(scan, sensor)) {
      REQUIRE(obstacles.touches_circle(truth.at(scan.utime) * point.p, 0.002));
      ++points;
    }
  }
  CHECK(points > 20000);
}

TEST_CASE(
    "an exact INS tells how far the robot has turned since the start, and how fast it turns") {
  SystemConfig config = apartment();
  config.ins.noise = "none";
  Messages run = batch(config, 4000);
  REQUIRE(run["INS"].size() == run["GROUND_TRUTH"].size());
  double start_rad = 0, last_rad = 0, fastest = 0;
  for (std::size_t k = 0; k < run["INS"].size(); ++k) {
    const TimedPose ins = to_timed_pose(decoded<bot_core::pose_t>(run["INS"][k]));
    const TimedPose truth = to_timed_pose(decoded<bot_core::pose_t>(run["GROUND_TRUTH"][k]));
    if (k == 0) start_rad = last_rad = truth.pose.heading;
    REQUIRE(ins.utime == truth.utime);
    REQUIRE(wrap_angle(truth.pose.heading - start_rad - ins.pose.heading) ==
            Approx(0).margin(1e-9));
    REQUIRE(ins.yaw_rate == Approx(wrap_angle(truth.pose.heading - last_rad) / 0.05).margin(1e-6));
    last_rad = truth.pose.heading;
    fastest = std::max(fastest, std::abs(ins.yaw_rate));
  }
  CHECK(fastest > 0.3);
}

TEST_CASE("driver none keeps a sensor silent") {
  SystemConfig config = apartment();
  config.ins.driver = config.laser.driver = config.odometry.driver = "none";
  const Messages run = batch(config, 100);
  CHECK(run.count("INS") + run.count("LASER") + run.count("ODOMETRY") == 0);
}

TEST_CASE("odometry of the safe loop errs as the profiles promise") {
  const World world = load_world(kWorlds + "/apartment.geojson");
  WorldSimulation simulation(world, route_of(world, "A_safe_loop"), false);
  std::vector<SimulationState> states = {simulation.state()};
  while (!simulation.state().finished) {
    simulation.advance();
    if (simulation.state().step % 5 == 0) states.push_back(simulation.state());
  }
  const auto median_m = [&](const std::string& profile) {
    std::vector<double> largest_m;
    for (std::uint64_t seed = 1; seed <= 41; ++seed) {
      NoisyOdometry odometry(odometry_noise(profile), seed);
      largest_m.push_back(0);
      for (std::size_t k = 1; k < states.size(); ++k) {
        odometry.advance(states[k].wheel_distance_m - states[k - 1].wheel_distance_m,
                         states[k].wheel_turn_rad - states[k - 1].wheel_turn_rad);
        const Pose2 T_world_odometry = states[0].T_world_base * odometry.T_odom_base();
        largest_m.back() =
            std::max(largest_m.back(), distance(T_world_odometry, states[k].T_world_base));
      }
    }
    std::sort(largest_m.begin(), largest_m.end());
    return largest_m[20];
  };
  const double none_m = median_m("none"), official_m = median_m("official"),
               raised_m = median_m("raised");
  INFO("none " << none_m << " official " << official_m << " raised " << raised_m);
  CHECK(none_m < 0.005);
  CHECK(official_m > 0.15);
  CHECK(official_m < 0.4);
  CHECK(raised_m > 5);
  CHECK(raised_m < 9);
}

}  // namespace
}  // namespace modslam
