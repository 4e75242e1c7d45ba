// SPDX-License-Identifier: BSD-3-Clause
/// The simulated world and its sensors on the in-process bus, and the log that simulate writes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <modslam/sim_info_t.hpp>
#include <random>
#include <set>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/simulation_messages.hpp"
#include "common/bus/system_config.hpp"
#include "procs/simulate/simulate.hpp"
#include "tests/support/matchers.hpp"

namespace modslam {
namespace {

const std::string kWorlds = MODSLAM_SOURCE_DIR "/config/worlds";

SystemConfig apartment(const std::string& route = "A_safe_loop") {
  SystemConfig config;
  config.simulator.world = kWorlds + "/apartment.geojson";
  config.simulator.route = route;
  return config;
}

using Messages = std::map<std::string, std::vector<std::string>>;  // channel -> bytes, in order

/// Simulator and sensors on one in-process bus, and all they said.
class Stage {
 public:
  explicit Stage(const SystemConfig& config, bool with_simulator = true) {
    if (with_simulator) host("simulator", make_simulator, config);
    host("odometry", make_odometry, config);
    host("ins", make_ins, config);
    host("laser", make_laser, config);
    transport.subscribe(".*", [this](const std::string& channel, const void* bytes, int size) {
      messages[channel].emplace_back(static_cast<const char*>(bytes),
                                     static_cast<std::size_t>(size));
    });
  }
  void drain() {
    while (transport.poll(0)) {
    }
  }
  Module& simulator() { return *modules.front(); }

  Transport transport{"memq://"};
  std::vector<std::unique_ptr<Bus>> buses;
  std::vector<std::unique_ptr<Module>> modules;
  Messages messages;

 private:
  void host(const std::string& name, ModuleFactory make, const SystemConfig& config) {
    buses.push_back(std::make_unique<Bus>(transport, name));
    modules.push_back(make(*buses.back(), config));
  }
};

Messages batch(const SystemConfig& config, std::int64_t steps) {
  Stage stage(config);
  for (std::int64_t k = 0; k < steps && stage.simulator().step(); ++k) stage.drain();
  return stage.messages;
}

template <class Message>
Message decoded(const std::string& bytes) {
  Message message{};
  REQUIRE(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) ==
          static_cast<int>(bytes.size()));
  return message;
}

std::string temporary(const std::string& name) {
  return (std::filesystem::temp_directory_path() / ("modslam_simulation_test_" + name)).string();
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Every LCM message: 8 bytes of fingerprint, then its fields; ours begin with utime, big-endian.
std::int64_t utime_of(const std::vector<char>& message) {
  std::uint64_t utime = 0;
  for (std::size_t k = 8; k < 16; ++k)
    utime = utime << 8 | static_cast<unsigned char>(message.at(k));
  return static_cast<std::int64_t>(utime);
}

TEST_CASE("the same configuration gives the same log, byte for byte, and another seed another") {
  SystemConfig config = apartment();
  const std::string a = temporary("a.lcm"), b = temporary("b.lcm"), c = temporary("c.lcm");
  const SimulatedRun run = simulate(config, a);
  simulate(config, b);
  config.simulator.seed = 2;
  simulate(config, c);
  CHECK(run.arrived);
  CHECK(run.path_m == Approx(85).margin(5));
  CHECK(run.scans == Approx(5 * run.duration_s).margin(2));
  CHECK(bytes_of(a) == bytes_of(b));
  CHECK(bytes_of(a) != bytes_of(c));
  for (const std::string& path : {a, b, c}) std::filesystem::remove(path);
}

TEST_CASE("the log explains itself first, bears message times and leaves SIM_STATE out") {
  const std::string path = temporary("order.lcm");
  simulate(apartment(), path);
  LogReader reader(path);
  LogEvent event;
  std::vector<std::string> first;
  std::set<std::string> channels;
  std::int64_t last_utime = 0, events = 0;
  while (reader.next(event)) {
    if (first.size() < 3) first.push_back(event.channel);
    channels.insert(event.channel);
    REQUIRE(event.utime == utime_of(event.bytes));
    REQUIRE(event.utime >= last_utime);
    last_utime = event.utime;
    ++events;
  }
  std::filesystem::remove(path);
  CHECK(first[0] == "PARAMETERS");
  CHECK(first[1] == "SIM_INFO");
  CHECK(channels == std::set<std::string>{"PARAMETERS", "SIM_INFO", "SENSOR_INFO", "GROUND_TRUTH",
                                          "ODOMETRY", "INS", "LASER"});
  CHECK(events > 10000);
}

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

TEST_CASE("a live run says what the batch run says, message for message") {
  SystemConfig config = apartment();
  config.simulator.speed = 3;
  const Messages expected = batch(config, 1500);
  Stage live(config);
  std::mt19937_64 random(11);
  std::int64_t steady_us = 123'456'789;
  while (live.messages["SIM_STATE"].size() < 1500) {
    live.simulator().tick(steady_us);
    live.drain();
    steady_us += 2000 + static_cast<std::int64_t>(random() % 9000);
  }
  for (const auto& [channel, messages] : expected) {
    INFO(channel);
    auto& said = live.messages[channel];
    REQUIRE(said.size() >= messages.size());
    said.resize(messages.size());
    CHECK(said == messages);
  }
}

TEST_CASE("a live run keeps the pace it was told, after its delay") {
  SystemConfig config = apartment();
  config.simulator.speed = 2;
  config.simulator.delay_s = 1;
  Stage live(config);
  for (std::int64_t us = 5'000'000; us <= 8'000'000; us += 5000) {
    live.simulator().tick(us);
    live.drain();
    if (us < 6'000'000) REQUIRE(live.messages["SIM_STATE"].empty());
  }
  CHECK(live.messages["SIM_STATE"].size() == Approx(400).margin(2));
}

TEST_CASE(
    "the simulator says that its route has ended, and repeats the last state for who missed it") {
  SystemConfig config = apartment();
  config.simulator.delay_s = 0;
  Stage live(config);
  CHECK_FALSE(live.simulator().ended());
  while (live.simulator().step()) live.drain();
  CHECK(live.simulator().ended());
  CHECK_FALSE(live.simulator().troubled());
  Messages before = live.messages;
  for (std::int64_t us = 1'000'000; us < 4'000'000; us += 5000) live.simulator().tick(us);
  live.drain();
  CHECK(live.messages["SIM_STATE"].size() - before["SIM_STATE"].size() == 3);
  CHECK(live.messages["SIM_STATE"].back() == before["SIM_STATE"].back());
  for (const char* channel : {"ODOMETRY", "LASER", "INS", "GROUND_TRUTH"})
    CHECK(live.messages[channel].size() == before[channel].size());
}

TEST_CASE("bad SIM_STATEs are refused and counted by each sensor, and none of them answers") {
  Stage stage(apartment(), false);
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
  stage.drain();
  for (const auto& bus : stage.buses) CHECK(bus->inputs().at(channel::kSimState).bad == 7);
  CHECK(stage.messages.size() == 1);  // SIM_STATE alone
  sender.publish(channel::kSimState, good);
  stage.drain();
  CHECK(stage.messages.count(channel::kLaser) == 1);
}

TEST_CASE("a state that comes late is refused, a repeated one passed over, and neither resets a sensor") {
  SystemConfig config = apartment();
  Messages expected = batch(config, 1200);
  Stage stage(config, false);
  const auto& states = expected.at("SIM_STATE");
  const auto send = [&](std::size_t step) {
    stage.transport.publish(channel::kSimState, states[step].data(), static_cast<int>(states[step].size()));
    stage.drain();
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
  for (const auto& bus : stage.buses) {
    CHECK(bus->inputs().at(channel::kSimState).bad == 2);
    CHECK(bus->inputs().at(channel::kSimState).gaps == 0);
  }
}

TEST_CASE("a simulation that was started again starts its sensors again") {
  SystemConfig config = apartment();
  Messages expected = batch(config, 600);
  Stage stage(config, false);
  for (int pass = 0; pass < 2; ++pass)
    for (const std::string& bytes : expected.at("SIM_STATE")) {
      stage.transport.publish(channel::kSimState, bytes.data(), static_cast<int>(bytes.size()));
      stage.drain();
    }
  for (const char* channel : {"ODOMETRY", "INS", "LASER"}) {
    INFO(channel);
    std::vector<std::string> twice = expected.at(channel);
    twice.insert(twice.end(), expected.at(channel).begin(), expected.at(channel).end());
    CHECK(stage.messages[channel] == twice);
  }
  for (const auto& bus : stage.buses) CHECK(bus->inputs().at(channel::kSimState).bad == 0);
}

TEST_CASE("the world is named at the start and every five seconds") {
  Messages run = batch(apartment(), 1201);
  REQUIRE(run["SIM_INFO"].size() == 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto info = decoded<sim_info_t>(run["SIM_INFO"][k]);
    CHECK(info.utime == WorldSimulation::utime_of(static_cast<std::int64_t>(500 * k)));
    CHECK(info.world == "apartment.geojson");
    CHECK(info.world_sha256.size() == 64);
  }
}

TEST_CASE("odometry loses nothing but time when states are lost") {
  SystemConfig config = apartment();
  config.odometry.noise = "none";
  const Messages all = batch(config, 4000);
  Stage lossy(config, false);
  std::mt19937_64 random(5);
  Pose2 T_world_start, T_world_last;
  for (const std::string& bytes : all.at("SIM_STATE")) {
    const auto state = to_simulation_state(decoded<sim_state_t>(bytes));
    if (state.step == 0) T_world_start = state.T_world_base;
    if (state.step > 0 && state.step % 5 != 0 && random() % 2) continue;
    if (state.step % 500 == 250) continue;  // one that was due
    lossy.transport.publish(channel::kSimState, bytes.data(), static_cast<int>(bytes.size()));
    lossy.drain();
    if (state.step % 5 == 0) T_world_last = state.T_world_base;
  }
  const auto last = to_timed_pose(decoded<bot_core::pose_t>(lossy.messages["ODOMETRY"].back()));
  CHECK_THAT(T_world_start * last.pose, IsNear(T_world_last, 0.005, 0.005));
  CHECK(lossy.buses[0]->inputs().at(channel::kSimState).gaps > 1000);
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

TEST_CASE("a world or route that is missing is named") {
  SystemConfig config = apartment("to_the_moon");
  CHECK_THROWS_WITH(simulate(config, temporary("none.lcm")), Catch::Contains("to_the_moon"));
  config.simulator.world = "no/such.geojson";
  CHECK_THROWS_WITH(simulate(config, temporary("none.lcm")), Catch::Contains("no/such.geojson"));
  CHECK_FALSE(std::filesystem::exists(temporary("none.lcm")));
}

TEST_CASE("every route of every world ends without contact") {
  int routes = 0;
  for (const auto& file : std::filesystem::directory_iterator(kWorlds)) {
    const World world = load_world(file.path().string());
    for (const Route& route : world.routes) {
      INFO(world.name << " " << route.id);
      WorldSimulation simulation(world, route, false);
      while (!simulation.state().finished && simulation.state().step < 200000) simulation.advance();
      CHECK(simulation.state().finished);
      CHECK(simulation.touching_steps() == 0);
      const Pose2 end = simulation.state().T_world_base;
      CHECK((end.translation() - route.points.back()).norm() < 0.1);
      ++routes;
    }
  }
  CHECK(routes >= 4);
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
