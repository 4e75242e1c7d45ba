// SPDX-License-Identifier: BSD-3-Clause
/// @file Between SIM_STATE and the simulation's own state, checked.
#pragma once
#include <functional>
#include <modslam/sim_state_t.hpp>

#include "common/bus/bus.hpp"
#include "common/bus/journal.hpp"
#include "common/world/step_period.hpp"
#include "common/world/world_simulation.hpp"

namespace modslam {

/// @throws BadMessage on non-finite values, a negative step, a utime that is not that step's.
SimulationState to_simulation_state(const sim_state_t& message);
sim_state_t to_message(const SimulationState& state);

/// SIM_STATE as a simulated sensor takes it: in order, each once. States that come late are refused, repeated ones passed over,
/// lost ones counted as gaps. What a sensor took stands in its journal: started again after a crash it takes that once more, without
/// saying anything, and is where it was, also in its noise.
class SimulationStates {
 public:
  /// `anew`: the first state, or the simulation was started again.
  using Handler = std::function<void(const SimulationState& state, bool anew)>;

  SimulationStates(Bus& bus, const JournalConfig& journal, Handler on_state);
  SimulationStates(const SimulationStates&) = delete;
  SimulationStates& operator=(const SimulationStates&) = delete;

  /// Hands over what an earlier life took; is_past() meanwhile.
  void resume();
  bool is_past() const { return past_; }
  std::int64_t lost() const { return lost_; }

 private:
  void take(const SimulationState& state);

  Bus& bus_;
  Handler on_state_;
  StepOrder order_;
  Journal journal_;
  bool past_ = false;
  std::int64_t lost_ = 0;
};

}  // namespace modslam
