// SPDX-License-Identifier: BSD-3-Clause
/// @file Simulator and sensors on the in-process bus, in the worlds of this repository.
#pragma once
#include <catch2/catch.hpp>
#include <map>
#include <string>
#include <vector>

#include "common/bus/modules.hpp"
#include "tests/support/stage.hpp"

namespace modslam::test {

inline const std::string kWorlds = MODSLAM_SOURCE_DIR "/config/worlds";

inline SystemConfig apartment(const std::string& route = "A_safe_loop") {
  SystemConfig config;
  config.simulator.world = kWorlds + "/apartment.geojson";
  config.simulator.route = route;
  return config;
}

using Messages = std::map<std::string, std::vector<std::string>>;  // channel -> bytes, in order

/// Simulator and sensors, and all they said.
class SimulationStage : public Stage {
 public:
  explicit SimulationStage(const SystemConfig& config, bool with_simulator = true) {
    if (with_simulator) simulator_ = &host("simulator", make_simulator, config);
    host("odometry", make_odometry, config);
    host("ins", make_ins, config);
    host("laser", make_laser, config);
    transport.subscribe(".*", [this](const std::string& channel, const void* bytes, int size) {
      messages[channel].emplace_back(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
    });
  }
  Module& simulator() { return *simulator_; }

  Messages messages;

 private:
  Module* simulator_ = nullptr;
};

inline Messages batch(const SystemConfig& config, std::int64_t steps) {
  SimulationStage stage(config);
  for (std::int64_t k = 0; k < steps && stage.simulator().step(); ++k) stage.settle();
  return stage.messages;
}

template <class Message>
Message decoded(const std::string& bytes) {
  Message message{};
  REQUIRE(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) ==
          static_cast<int>(bytes.size()));
  return message;
}

}  // namespace modslam::test
