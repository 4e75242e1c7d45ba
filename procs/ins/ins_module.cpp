// SPDX-License-Identifier: BSD-3-Clause
/// procs/ins — SIM_STATE (sim_state_t) → INS: orientation and rotation rate. Config: [ins],
/// [simulator] seed.
#include <optional>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/simulation_messages.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

class InsModule : public Module {
 public:
  InsModule(Bus& bus, const SystemConfig& config)
      : bus_(bus),
        config_(config.ins),
        seed_(static_cast<std::uint64_t>(config.simulator.seed)),
        period_(config_.rate_hz, WorldSimulation::kSteps_per_s),
        ins_(config_.noise, seed_) {
    if (config_.driver != "simulated") return;
    bus.publishes(channel::kIns);
    states_.emplace(bus, config.journal, [this](const SimulationState& state, bool anew) { on_state(state, anew); });
    states_->resume();
  }

  std::string words() const override {
    return states_ ? "simulated, noise " + config_.noise : "driver none";
  }

 private:
  void on_state(const SimulationState& state, bool anew) {
    if (anew) {
      ins_ = NoisyIns(config_.noise, seed_);
      last_.reset();
    }
    if (!period_.due(state.step)) return;
    if (last_)
      ins_.advance(wrap_angle(state.T_world_base.heading - last_->T_world_base.heading),
                   WorldSimulation::time_s(state.step - last_->step));
    last_ = state;
    if (states_->is_past()) return;
    const std::int64_t utime = WorldSimulation::utime_of(state.step);
    bus_.saw_utime(utime);
    bus_.publish(channel::kIns,
                 to_message(TimedPose{utime, Pose2(0, 0, ins_.heading_rad()), ins_.yaw_rate()}));
  }

  Bus& bus_;
  InsConfig config_;
  std::uint64_t seed_;
  StepPeriod period_;
  NoisyIns ins_;
  std::optional<SimulationState> last_;
  std::optional<SimulationStates> states_;
};

}  // namespace

std::unique_ptr<Module> make_ins(Bus& bus, const SystemConfig& config) {
  return std::make_unique<InsModule>(bus, config);
}

}  // namespace modslam
