// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>

#include "common/bus/system_config.hpp"

namespace modslam {

struct SimulatedRun {
  double duration_s = 0;  ///< of simulated time
  double path_m = 0;      ///< driven in truth
  double odometry_max_error_m =
      0;  ///< largest distance of odometry, laid on the true start, from the truth
  std::int64_t scans = 0;
  bool arrived = false;  ///< false: stuck at an obstacle
  std::string words;     ///< of the simulator
};

/// Drives the configured route as fast as the machine and writes what the sensors say as an LCM
/// log: PARAMETERS, SIM_INFO, SENSOR_INFO, GROUND_TRUTH, ODOMETRY, INS, LASER. Same configuration,
/// same bytes.
/// @throws std::runtime_error or std::invalid_argument naming the file or value that is wrong.
SimulatedRun simulate(const SystemConfig& config, const std::string& log_path);

}  // namespace modslam
