// SPDX-License-Identifier: BSD-3-Clause
#include "procs/simulate/simulate.hpp"

#include <algorithm>
#include <modslam/parameters_t.hpp>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/config.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/simulation_messages.hpp"

namespace modslam {
namespace {

/// The figures of a run, from what is on the bus.
class Summary {
 public:
  explicit Summary(Bus& bus) {
    bus.subscribe<bot_core::planar_lidar_t>(
        channel::kLaser, [this](const bot_core::planar_lidar_t&) { ++run.scans; });
    bus.subscribe<bot_core::pose_t>(
        channel::kGroundTruth, [this](const bot_core::pose_t& m) { add_truth(to_timed_pose(m)); });
    bus.subscribe<bot_core::pose_t>(
        channel::kOdometry, [this](const bot_core::pose_t& m) { add_odometry(to_timed_pose(m)); });
  }
  SimulatedRun run;

 private:
  void add_truth(const TimedPose& truth) {
    if (truth_)
      run.path_m += distance(truth_->pose, truth.pose);
    else
      T_world_start_ = truth.pose;
    truth_ = truth;
  }
  void add_odometry(const TimedPose& odometry) {
    if (!truth_ || truth_->utime != odometry.utime) return;
    const double error_m = distance(T_world_start_ * odometry.pose, truth_->pose);
    run.odometry_max_error_m = std::max(run.odometry_max_error_m, error_m);
  }

  std::optional<TimedPose> truth_;
  Pose2 T_world_start_;
};

/// A module with its own view of the bus.
struct Hosted {
  Hosted(Transport& transport, const std::string& name, ModuleFactory make,
         const SystemConfig& config)
      : bus(transport, name), module(make(bus, config)) {}
  Bus bus;
  std::unique_ptr<Module> module;
};

void drain(Transport& transport) {
  while (transport.poll(0)) {
  }
}

}  // namespace

SimulatedRun simulate(const SystemConfig& config, const std::string& log_path) {
  Transport transport("memq://");
  Bus bus(transport, "simulate");
  // Every message is the answer to a state of the simulation and carries that state's time.
  std::int64_t utime = WorldSimulation::kStart_utime;
  bus.subscribe<sim_state_t>(channel::kSimState, [&](const sim_state_t& m) { utime = m.utime; });
  // Odometry first: a scan then finds its odometry before it in the log.
  Hosted simulator(transport, "simulator", make_simulator, config);
  Hosted odometry(transport, "odometry", make_odometry, config);
  Hosted ins(transport, "ins", make_ins, config);
  Hosted laser(transport, "laser", make_laser, config);
  Summary summary(bus);
  LogWriter log(log_path);
  transport.subscribe(".*", [&](const std::string& channel, const void* bytes, int size) {
    if (channel != channel::kSimState) log.write(utime, channel, bytes, size);
  });
  parameters_t parameters{};
  parameters.utime = utime;
  parameters.name = bus.name();
  parameters.toml = to_toml(config, false);
  bus.publish(channel::kParameters, parameters);
  while (simulator.module->step()) drain(transport);
  log.close();
  summary.run.duration_s = 1e-6 * static_cast<double>(utime - WorldSimulation::kStart_utime);
  summary.run.arrived = !simulator.module->troubled();
  summary.run.words = simulator.module->words();
  return summary.run;
}

}  // namespace modslam
