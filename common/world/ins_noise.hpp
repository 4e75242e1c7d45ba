// SPDX-License-Identifier: BSD-3-Clause
/// @file A gyroscope that drifts, or the inertial sensor as USARSim models it.
#pragma once
#include <cstdint>
#include <string>

#include "common/config/visitor.hpp"
#include "common/world/random.hpp"

namespace modslam {

struct InsConfig {
  static constexpr const char* kTable = "ins";
  std::string driver = "simulated";
  std::string noise = "gyro";
  double rate_hz = 20;

  void visit(ConfigVisitor& v) {
    v.choice("driver", driver, {"simulated", "none"},
             "Where the orientation comes from; none: no INS, or somebody else publishes it.");
    v.choice("noise", noise, {"none", "gyro", "usarsim"},
             "Simulated error: gyro drifts with time, usarsim errs in proportion to the turn.");
    v.number("rate_hz", rate_hz, 1, 100, "Hz",
             "Messages a second of simulated time, in whole steps of 10 ms.");
  }
};

/// Integrates noisy turns; starts at heading 0, as a gyroscope knows no north.
class NoisyIns {
 public:
  /// @throws std::invalid_argument for a noise that is not in InsConfig.
  NoisyIns(const std::string& noise, std::uint64_t seed);
  /// The robot turned by `turn_rad` in `dt_s` > 0.
  void advance(double turn_rad, double dt_s);
  double heading_rad() const { return heading_rad_; }
  double yaw_rate() const { return yaw_rate_; }  ///< [rad/s] measured mean of the last advance

 private:
  double measured_turn_rad(double turn_rad, double dt_s);

  enum class Model { kNone, kGyro, kUsarsim } model_;
  RandomStream random_;
  double bias_rad_s_ = 0;  ///< gyro
  double mean_ = 0;        ///< usarsim: constant part of the relative error
  double heading_rad_ = 0, yaw_rate_ = 0;
};

}  // namespace modslam
