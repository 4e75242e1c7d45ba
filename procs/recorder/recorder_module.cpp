// SPDX-License-Identifier: BSD-3-Clause
/// procs/recorder — everything but SIM_STATE → the run's LCM log. Config: [recorder].
/// The stock lcm-logger keeps 30 messages a subscription and drops the rest when the machine is busy; this one drops none that reached it.
#include <chrono>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

std::int64_t wall_clock_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class RecorderModule : public Module {
 public:
  RecorderModule(Bus& bus, const SystemConfig& config) : log_(config.recorder.path, LogWriter::kAppend) {
    bus.subscribe_bytes(".*", [this](const std::string& channel, const void* bytes, int size) {
      if (channel == channel::kSimState || channel == "LCM_SELF_TEST") return;
      log_.write(wall_clock_us(), channel, bytes, size);
      ++events_;
    });
  }

  void finish() override { log_.flush(); }
  void tick(std::int64_t steady_us) override {
    if (steady_us - flushed_us_ < kFlushEvery_us) return;
    flushed_us_ = steady_us;
    log_.flush();
  }
  std::string words() const override { return std::to_string(events_) + " messages recorded"; }

 private:
  static constexpr std::int64_t kFlushEvery_us = 200'000;
  LogWriter log_;
  std::int64_t events_ = 0, flushed_us_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_recorder(Bus& bus, const SystemConfig& config) {
  return std::make_unique<RecorderModule>(bus, config);
}

}  // namespace modslam
