// SPDX-License-Identifier: BSD-3-Clause
/// procs/laser — SIM_STATE (sim_state_t) → LASER, SENSOR_INFO. Config: [laser], [simulator].
#include <optional>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/simulation_messages.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

constexpr double kInfoRate_hz = 0.2;

class LaserModule : public Module {
 public:
  LaserModule(Bus& bus, const SystemConfig& config)
      : bus_(bus),
        config_(config.laser),
        seed_(static_cast<std::uint64_t>(config.simulator.seed)),
        model_(laser_model(config_.model)),
        sensor_(simulated_sensor(config_)),
        sweep_period_(config_.rate_hz, WorldSimulation::kSteps_per_s),
        info_period_(kInfoRate_hz, WorldSimulation::kSteps_per_s) {
    if (config_.driver != "simulated") return;
    obstacles_ =
        std::make_unique<Obstacles>(load_world(config.simulator.world), config.simulator.people);
    bus.publishes(channel::kLaser);
    bus.publishes(channel::kSensorInfo);
    states_.emplace(bus, JournalConfig(), [this](const SimulationState& state, bool) { on_state(state); });
  }

  std::string words() const override {
    if (!obstacles_) return "driver none";
    return std::to_string(sweeps_) + " sweeps of a simulated " + config_.model;
  }

 private:
  void on_state(const SimulationState& state) {
    const std::int64_t utime = WorldSimulation::utime_of(state.step);
    bus_.saw_utime(utime);
    if (info_period_.due(state.step))
      bus_.publish(channel::kSensorInfo, to_message(sensor_, utime));
    if (sweep_period_.due(state.step)) bus_.publish(channel::kLaser, to_message(sweep(state)));
  }

  Scan sweep(const SimulationState& state) {
    obstacles_->set_time(WorldSimulation::time_s(state.step));
    const Pose2 T_world_laser = state.T_world_base * sensor_.T_base_laser;
    Scan scan;
    scan.utime = WorldSimulation::utime_of(state.step);
    scan.rad0 = model_.rad0;
    scan.radstep = model_.radstep;
    for (int beam = 0; beam < model_.beams; ++beam)
      scan.ranges_m.push_back(static_cast<float>(obstacles_->cast(
          T_world_laser.translation(), T_world_laser.heading + model_.rad0 + beam * model_.radstep,
          model_.range_max_m)));
    add_laser_noise(scan.ranges_m, config_, model_, seed_, static_cast<std::uint64_t>(state.step));
    ++sweeps_;
    return scan;
  }

  Bus& bus_;
  LaserConfig config_;
  std::uint64_t seed_;
  LaserModel model_;
  SensorInfo sensor_;
  StepPeriod sweep_period_, info_period_;
  std::unique_ptr<Obstacles> obstacles_;
  std::int64_t sweeps_ = 0;
  std::optional<SimulationStates> states_;
};

}  // namespace

std::unique_ptr<Module> make_laser(Bus& bus, const SystemConfig& config) {
  return std::make_unique<LaserModule>(bus, config);
}

}  // namespace modslam
