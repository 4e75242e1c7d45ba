// SPDX-License-Identifier: BSD-3-Clause
/// @file Between SIM_STATE and the simulation's own state, checked.
#pragma once
#include <modslam/sim_state_t.hpp>

#include "common/world/world_simulation.hpp"

namespace modslam {

/// @throws BadMessage on non-finite values, a negative step, a utime that is not that step's.
SimulationState to_simulation_state(const sim_state_t& message);
sim_state_t to_message(const SimulationState& state);

}  // namespace modslam
