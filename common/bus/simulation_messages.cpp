// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/simulation_messages.hpp"

#include <cmath>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"

namespace modslam {
namespace {

constexpr std::int64_t kMaxStep = 10'000'000'000;  // three years
constexpr double kMaxWheels = 1e7;                 // [m] or [rad]

double bounded(double value, double bound, const char* what) {
  if (!(std::abs(value) <= bound))
    throw BadMessage(std::string(what) + " is " + std::to_string(value) + ": expected within +-" +
                     std::to_string(bound));
  return value;
}

}  // namespace

SimulationState to_simulation_state(const sim_state_t& message) {
  if (message.step < 0 || message.step > kMaxStep)
    throw BadMessage("step " + std::to_string(message.step) + " is out of range");
  if (message.utime != WorldSimulation::utime_of(message.step))
    throw BadMessage("utime " + std::to_string(message.utime) + " is not that of step " +
                     std::to_string(message.step));
  SimulationState state;
  state.step = message.step;
  state.T_world_base = to_pose(message.T_world_base);
  state.wheel_distance_m = bounded(message.wheel_distance_m, kMaxWheels, "wheel_distance_m");
  state.wheel_turn_rad = bounded(message.wheel_turn_rad, kMaxWheels, "wheel_turn_rad");
  state.yaw_rate = bounded(message.yaw_rate, 100, "yaw_rate");
  state.finished = message.finished != 0;
  return state;
}

sim_state_t to_message(const SimulationState& state) {
  sim_state_t message{};
  message.utime = WorldSimulation::utime_of(state.step);
  message.step = state.step;
  put(message.T_world_base, state.T_world_base);
  message.wheel_distance_m = state.wheel_distance_m;
  message.wheel_turn_rad = state.wheel_turn_rad;
  message.yaw_rate = state.yaw_rate;
  message.finished = state.finished;
  return message;
}

SimulationStates::SimulationStates(Bus& bus, const JournalConfig& journal, Handler on_state)
    : bus_(bus), on_state_(std::move(on_state)), journal_(journal, bus.name()) {
  bus.subscribe<sim_state_t>(channel::kSimState, [this](const sim_state_t& m) { take(to_simulation_state(m)); });
}

void SimulationStates::resume() {
  past_ = true;
  sim_state_t message{};
  journal_.read_past([&](const LogEvent& record) {
    if (read_record(record, message)) take(to_simulation_state(message));
  });
  past_ = false;
}

void SimulationStates::take(const SimulationState& state) {
  const StepOrder::Kind kind = order_.see(state.step);
  if (kind == StepOrder::Kind::kRepeated) return;
  if (kind == StepOrder::Kind::kLate)
    throw BadMessage("step " + std::to_string(state.step) + " comes after step " + std::to_string(order_.newest()));
  if (!past_) {
    if (order_.skipped() > 0) bus_.count_gap(channel::kSimState, order_.skipped());
    lost_ += order_.skipped();
    journal_.write(channel::kSimState, to_message(state));
  }
  on_state_(state, kind == StepOrder::Kind::kAnew);
}

}  // namespace modslam
