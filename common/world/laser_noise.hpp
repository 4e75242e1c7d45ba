// SPDX-License-Identifier: BSD-3-Clause
/// @file The laser scanners that can be simulated, and what they add to the true ranges.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/config/visitor.hpp"
#include "common/scan/scan.hpp"
#include "common/world/random.hpp"

namespace modslam {

struct LaserConfig {
  static constexpr const char* kTable = "laser";
  std::string driver = "simulated";
  std::string model = "sick";
  std::string noise = "gaussian";
  double sigma_m = 0.01;
  double sigma_per_m = 0.0;
  double dropout = 0.002;
  double rate_hz = 5;
  double mount_x_m = 0.1, mount_y_m = 0.0, mount_yaw_rad = 0.0;

  void visit(ConfigVisitor& v) {
    v.choice("driver", driver, {"simulated", "none"},
             "Where sweeps come from; none: somebody else publishes LASER.");
    v.choice("model", model, {"sick", "urg", "hokuyo-270"},
             "Scanner: 181 beams over 180 deg to 20 m; 228 over 240 deg to 4 m; 1081 over 270 deg "
             "to 30 m.");
    v.choice("noise", noise, {"none", "gaussian", "usarsim"},
             "Error of a range: none, normal with the two sigmas below, or even within 0.1 %.");
    v.number("sigma_m", sigma_m, 0, 0.5, "m", "Gaussian noise, constant part.");
    v.number("sigma_per_m", sigma_per_m, 0, 0.1, "m/m",
             "Gaussian noise, part that grows with the range.");
    v.number("dropout", dropout, 0, 0.5, "",
             "Share of the beams whose return is lost: they read the largest range.");
    v.number("rate_hz", rate_hz, 0.5, 50, "Hz",
             "Sweeps a second of simulated time, in whole steps of 10 ms.");
    v.number("mount_x_m", mount_x_m, -2, 2, "m",
             "The scanner's place ahead of the robot's centre.");
    v.number("mount_y_m", mount_y_m, -2, 2, "m", "Its place left of the centre.");
    v.number("mount_yaw_rad", mount_yaw_rad, -3.15, 3.15, "rad", "Its turn to the left.");
  }
};

/// Beam i points to rad0 + i * radstep in the laser frame.
struct LaserModel {
  int beams;
  double rad0, radstep;
  double range_min_m, range_max_m;
};

/// @throws std::invalid_argument for a model that is not in LaserConfig.
LaserModel laser_model(const std::string& name);

/// What others must know of the simulated scanner (message SENSOR_INFO).
SensorInfo simulated_sensor(const LaserConfig& config);

/// Turns true ranges [m] into measured ones; a miss and a dropout read range_max_m.
/// The draws of sweep number `sweep` depend on nothing but seed and number.
void add_laser_noise(std::vector<float>& ranges_m, const LaserConfig& config,
                     const LaserModel& model, std::uint64_t seed, std::uint64_t sweep);

}  // namespace modslam
