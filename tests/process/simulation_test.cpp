// SPDX-License-Identifier: BSD-3-Clause
/// The simulated world on the in-process bus, and the log that simulate writes.
#include <filesystem>
#include <fstream>
#include <modslam/sim_info_t.hpp>
#include <set>

#include "common/bus/channels.hpp"
#include "common/bus/log.hpp"
#include "common/bus/simulation_messages.hpp"
#include "procs/simulate/simulate.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/simulation_stage.hpp"

namespace modslam {
namespace {

using namespace test;

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

TEST_CASE("a live run says what the batch run says, message for message") {
  SystemConfig config = apartment();
  config.simulator.speed = 3;
  const Messages expected = batch(config, 1500);
  SimulationStage live(config);
  std::mt19937_64 random(11);
  std::int64_t steady_us = 123'456'789;
  while (live.messages["SIM_STATE"].size() < 1500) {
    live.simulator().tick(steady_us);
    live.settle();
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
  SimulationStage live(config);
  for (std::int64_t us = 5'000'000; us <= 8'000'000; us += 5000) {
    live.simulator().tick(us);
    live.settle();
    if (us < 6'000'000) REQUIRE(live.messages["SIM_STATE"].empty());
  }
  CHECK(live.messages["SIM_STATE"].size() == Approx(400).margin(2));
}

TEST_CASE(
    "the simulator says that its route has ended, and repeats the last state for who missed it") {
  SystemConfig config = apartment();
  config.simulator.delay_s = 0;
  SimulationStage live(config);
  CHECK_FALSE(live.simulator().ended());
  while (live.simulator().step()) live.settle();
  CHECK(live.simulator().ended());
  CHECK_FALSE(live.simulator().troubled());
  Messages before = live.messages;
  for (std::int64_t us = 1'000'000; us < 4'000'000; us += 5000) live.simulator().tick(us);
  live.settle();
  CHECK(live.messages["SIM_STATE"].size() - before["SIM_STATE"].size() == 3);
  CHECK(live.messages["SIM_STATE"].back() == before["SIM_STATE"].back());
  for (const char* channel : {"ODOMETRY", "LASER", "INS", "GROUND_TRUTH"})
    CHECK(live.messages[channel].size() == before[channel].size());
}

TEST_CASE("a simulation that was started again starts its sensors again") {
  SystemConfig config = apartment();
  Messages expected = batch(config, 600);
  SimulationStage stage(config, false);
  for (int pass = 0; pass < 2; ++pass)
    for (const std::string& bytes : expected.at("SIM_STATE")) {
      stage.transport.publish(channel::kSimState, bytes.data(), static_cast<int>(bytes.size()));
      stage.settle();
    }
  for (const char* channel : {"ODOMETRY", "INS", "LASER"}) {
    INFO(channel);
    std::vector<std::string> twice = expected.at(channel);
    twice.insert(twice.end(), expected.at(channel).begin(), expected.at(channel).end());
    CHECK(stage.messages[channel] == twice);
  }
  for (const auto& bus : stage.buses()) CHECK(bus->inputs().at(channel::kSimState).bad == 0);
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

}  // namespace
}  // namespace modslam
