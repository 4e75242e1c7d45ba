// SPDX-License-Identifier: BSD-3-Clause
/// procs/simulator — nothing → SIM_INFO, SIM_STATE, GROUND_TRUTH: drives a route through a world.
/// Config: [simulator].
#include <algorithm>
#include <filesystem>
#include <modslam/sim_info_t.hpp>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/simulation_messages.hpp"
#include "common/bus/system_config.hpp"
#include "common/formats/file_bytes.hpp"
#include "common/formats/sha256.hpp"
#include "common/world/step_period.hpp"

namespace modslam {
namespace {

constexpr double kTruthRate_hz = 20;
constexpr double kInfoRate_hz = 0.2;
constexpr std::int64_t kMaxStepsPerTick = 100;  // a machine that falls behind slows the world down

class SimulatorModule : public Module {
 public:
  SimulatorModule(Bus& bus, const SystemConfig& config)
      : bus_(bus),
        config_(config.simulator),
        noise_(config.odometry.noise),
        world_(load_world(config_.world)),
        simulation_(world_, to_and_fro(route_of(world_, config_.route), config_.laps), config_.people),
        truth_period_(kTruthRate_hz, WorldSimulation::kSteps_per_s),
        info_period_(kInfoRate_hz, WorldSimulation::kSteps_per_s),
        info_(describe()),
        journal_(config.journal, bus.name()) {
    resume();
  }

  bool step() override {
    if (simulation_.state().finished) return false;
    if (started_) simulation_.advance();
    started_ = true;
    publish_state();
    return true;
  }

  void tick(std::int64_t steady_us) override {
    if (next_step_us_ == 0 && started_) next_step_us_ = steady_us;
    if (next_step_us_ == 0)
      next_step_us_ = steady_us + static_cast<std::int64_t>(1e6 * config_.delay_s);
    const auto step_us = static_cast<std::int64_t>(WorldSimulation::kStep_us / config_.speed);
    for (std::int64_t k = 0; k < kMaxStepsPerTick && next_step_us_ <= steady_us;
         ++k, next_step_us_ += step_us)
      if (!step()) return repeat_end(steady_us);
    next_step_us_ = std::max(next_step_us_, steady_us - kMaxStepsPerTick * step_us);
  }

  bool ended() const override { return simulation_.state().finished; }

  bool troubled() const override { return simulation_.stuck(); }

  std::string words() const override {
    std::string text = std::filesystem::path(config_.world).filename().string() + ", route " +
                       config_.route + ": ";
    text += std::to_string(simulation_.path_m()).substr(0, 5) + " m driven, " +
            std::to_string(simulation_.touching_steps()) + " steps in contact";
    if (simulation_.stuck()) return text + ", stuck at an obstacle";
    return simulation_.state().finished ? text + ", arrived" : text;
  }

 private:
  /// After a crash: drives in no time to where the last life was.
  void resume() {
    sim_state_t last{};
    journal_.read_past([&](const LogEvent& record) { read_record(record, last); });
    started_ = journal_.last_us() != 0;
    while (simulation_.state().step < last.step && !simulation_.state().finished) simulation_.advance();
  }

  sim_info_t describe() const {
    sim_info_t message{};
    message.world = std::filesystem::path(config_.world).filename().string();
    message.world_sha256 = sha256(read_file_bytes(config_.world).bytes);
    message.route = config_.route;
    message.noise = noise_;
    message.seed = config_.seed;
    put(message.T_world_start, simulation_.state().T_world_base);
    return message;
  }

  /// At the start and every five seconds: who comes later must know the world too.
  void publish_info() {
    info_.utime = simulation_.utime();
    bus_.publish(channel::kSimInfo, info_);
  }

  void publish_state() {
    const SimulationState& state = simulation_.state();
    bus_.saw_utime(simulation_.utime());
    journal_.write("SIM_STATE", to_message(state));
    bus_.publish(channel::kSimState, to_message(state));
    if (info_period_.due(state.step)) publish_info();
    if (!truth_period_.due(state.step)) return;
    bot_core::pose_t truth =
        to_message(TimedPose{simulation_.utime(), state.T_world_base, state.yaw_rate});
    truth.vel[0] = state.speed_mps * std::cos(state.T_world_base.heading);
    truth.vel[1] = state.speed_mps * std::sin(state.T_world_base.heading);
    bus_.publish(channel::kGroundTruth, truth);
  }

  /// Says once a second that the route has ended: a network may lose it.
  void repeat_end(std::int64_t steady_us) {
    next_step_us_ = steady_us + 1'000'000;
    bus_.publish(channel::kSimState, to_message(simulation_.state()));
  }

  Bus& bus_;
  SimulatorConfig config_;
  std::string noise_;
  World world_;
  WorldSimulation simulation_;
  StepPeriod truth_period_, info_period_;
  sim_info_t info_;
  Journal journal_;
  bool started_ = false;
  std::int64_t next_step_us_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_simulator(Bus& bus, const SystemConfig& config) {
  return std::make_unique<SimulatorModule>(bus, config);
}

}  // namespace modslam
