// SPDX-License-Identifier: BSD-3-Clause
/// @file Modules and their helpers on the in-process bus, and whatever they say.
#pragma once
#include <map>

#include "common/bus/bus.hpp"
#include "common/bus/module.hpp"
#include "common/bus/system_config.hpp"

namespace modslam::test {

class Stage {
 public:
  Bus& bus(const std::string& name) {
    buses_.push_back(std::make_unique<Bus>(transport, name));
    return *buses_.back();
  }
  Module& host(const std::string& name, ModuleFactory make, const SystemConfig& config = {}) {
    modules_.push_back(make(bus(name), config));
    return *modules_.back();
  }
  /// Keeps every message of a channel from now on.
  template <class Message>
  std::vector<Message>& record(const std::string& channel) {
    auto list = std::make_shared<std::vector<Message>>();
    recorder_.subscribe<Message>(channel, [list](const Message& m) { list->push_back(m); });
    return *list;
  }
  /// Handles messages until nobody says anything more; ticks after each round.
  void drain(int rounds = 3) {
    for (int round = 0; round < rounds; ++round) {
      settle();
      for (auto& module : modules_) module->tick(0);
    }
    settle();
  }
  /// The same without a tick: no time passes.
  void settle() {
    while (transport.poll(0)) {
    }
  }
  const std::vector<std::unique_ptr<Bus>>& buses() const { return buses_; }

  Transport transport{"memq://"};

 private:
  Bus recorder_{transport, "recorder"};
  std::vector<std::unique_ptr<Bus>> buses_;
  std::vector<std::unique_ptr<Module>> modules_;
};

}  // namespace modslam::test
