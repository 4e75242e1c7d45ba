// SPDX-License-Identifier: BSD-3-Clause
/// @file Between SIM_STATE and the simulation's own state, checked.
#pragma once
#include <functional>
#include <modslam/sim_state_t.hpp>

#include "common/bus/bus.hpp"
#include "common/world/step_period.hpp"
#include "common/world/world_simulation.hpp"

namespace modslam {

/// @throws BadMessage on non-finite values, a negative step, a utime that is not that step's.
SimulationState to_simulation_state(const sim_state_t& message);
sim_state_t to_message(const SimulationState& state);

/// SIM_STATE as a simulated sensor takes it: in order, each once. States that come late are refused, repeated ones passed over,
/// lost ones counted as gaps.
class SimulationStates {
 public:
  /// `anew`: the first state, or the simulation was started again.
  using Handler = std::function<void(const SimulationState& state, bool anew)>;

  SimulationStates(Bus& bus, Handler on_state);
  SimulationStates(const SimulationStates&) = delete;
  SimulationStates& operator=(const SimulationStates&) = delete;

  std::int64_t lost() const { return lost_; }

 private:
  void take(const SimulationState& state);

  Bus& bus_;
  Handler on_state_;
  StepOrder order_;
  std::int64_t lost_ = 0;
};

}  // namespace modslam
