// SPDX-License-Identifier: BSD-3-Clause
/// procs/odometry — SIM_STATE (sim_state_t) → ODOMETRY. Config: [odometry], [simulator] seed.
#include <optional>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/simulation_messages.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

class OdometryModule : public Module {
 public:
  OdometryModule(Bus& bus, const SystemConfig& config)
      : bus_(bus),
        config_(config.odometry),
        seed_(static_cast<std::uint64_t>(config.simulator.seed)),
        period_(config_.rate_hz, WorldSimulation::kSteps_per_s),
        odometry_(odometry_noise(config_.noise), seed_) {
    if (config_.driver != "simulated") return;
    bus.publishes(channel::kOdometry);
    states_.emplace(bus, config.journal, [this](const SimulationState& state, bool anew) { on_state(state, anew); });
    states_->resume();
  }

  std::string words() const override {
    if (!states_) return "driver none";
    return "simulated wheels, noise " + config_.noise + ", " + std::to_string(states_->lost()) +
           " states missed";
  }

 private:
  void on_state(const SimulationState& state, bool anew) {
    if (anew) {
      odometry_ = NoisyOdometry(odometry_noise(config_.noise), seed_);
      last_.reset();
    }
    if (!period_.due(state.step)) return;
    if (last_)  // wheel counts are totals: a state that was lost takes nothing away
      odometry_.advance(state.wheel_distance_m - last_->wheel_distance_m,
                        state.wheel_turn_rad - last_->wheel_turn_rad);
    if (!states_->is_past()) publish(state);
    last_ = state;
  }

  void publish(const SimulationState& state) {
    const double dt_s = last_ ? WorldSimulation::time_s(state.step - last_->step) : 0;
    const double yaw_rate = dt_s > 0 ? odometry_.counted_turn_rad() / dt_s : 0;
    const std::int64_t utime = WorldSimulation::utime_of(state.step);
    bus_.saw_utime(utime);
    bus_.publish(channel::kOdometry,
                 to_message(TimedPose{utime, odometry_.T_odom_base(), yaw_rate}));
  }

  Bus& bus_;
  OdometryConfig config_;
  std::uint64_t seed_;
  StepPeriod period_;
  NoisyOdometry odometry_;
  std::optional<SimulationState> last_;
  std::optional<SimulationStates> states_;
};

}  // namespace

std::unique_ptr<Module> make_odometry(Bus& bus, const SystemConfig& config) {
  return std::make_unique<OdometryModule>(bus, config);
}

}  // namespace modslam
