// SPDX-License-Identifier: BSD-3-Clause
/// procs/odometry — SIM_STATE (sim_state_t) → ODOMETRY. Config: [odometry], [simulator] seed.
#include <optional>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/simulation_messages.hpp"
#include "common/bus/system_config.hpp"
#include "common/world/step_period.hpp"

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
    bus.subscribe<sim_state_t>(channel::kSimState,
                               [this](const sim_state_t& m) { on_state(to_simulation_state(m)); });
  }

  std::string words() const override {
    if (config_.driver != "simulated") return "driver none";
    return "simulated wheels, noise " + config_.noise + ", " + std::to_string(lost_) +
           " states missed";
  }

 private:
  void on_state(const SimulationState& state) {
    count_lost(state.step);
    if (!period_.due(state.step)) return;
    if (!last_ || state.step < last_->step)  // the first, or the simulation began anew
      odometry_ = NoisyOdometry(odometry_noise(config_.noise), seed_);
    else  // wheel counts are totals: a state that was lost takes nothing away
      odometry_.advance(state.wheel_distance_m - last_->wheel_distance_m,
                        state.wheel_turn_rad - last_->wheel_turn_rad);
    publish(state);
    last_ = state;
  }

  void count_lost(std::int64_t step) {
    if (newest_step_ >= 0 && step > newest_step_ + 1) {
      lost_ += step - newest_step_ - 1;
      bus_.count_gap(channel::kSimState, step - newest_step_ - 1);
    }
    newest_step_ = step;
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
  std::int64_t newest_step_ = -1, lost_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_odometry(Bus& bus, const SystemConfig& config) {
  return std::make_unique<OdometryModule>(bus, config);
}

}  // namespace modslam
