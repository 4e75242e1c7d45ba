// SPDX-License-Identifier: BSD-3-Clause
/// @file Wheel odometry as a real robot has it: wrong scales, drawn once, and white noise.
///
/// For wheels that rolled ds [m] and turned the robot by dth [rad], the odometer counts
///     ds'  = ds  (1 + b_s) + k_d sqrt|ds| N
///     dth' = dth (1 + b_w) + c ds + k_dt sqrt|ds| N + k_tt sqrt|dth| N
/// with N standard normal and b_s, b_w, c drawn once a run. Variances grow with the way, so the
/// error does not depend on how finely the way is cut.
#pragma once
#include <cstdint>
#include <string>

#include "common/config/visitor.hpp"
#include "common/geometry/pose2.hpp"
#include "common/world/random.hpp"

namespace modslam {

struct OdometryConfig {
  static constexpr const char* kTable = "odometry";
  std::string driver = "simulated";
  std::string noise = "official";
  double rate_hz = 20;

  void visit(ConfigVisitor& v) {
    v.choice("driver", driver, {"simulated", "none"},
             "Where wheel odometry comes from; none: somebody else publishes ODOMETRY.");
    v.choice("noise", noise, {"none", "official", "raised"},
             "Simulated error: official is about 0.25 m after 85 m, raised about 7 m.");
    v.number("rate_hz", rate_hz, 1, 100, "Hz",
             "Messages a second of simulated time, in whole steps of 10 ms.");
  }
};

/// Factors of the formula above. Units: m/sqrt(m), rad/sqrt(m), rad/sqrt(rad), 1, 1, rad/m.
struct OdometryNoise {
  double k_d = 0, k_dt = 0, k_tt = 0;
  double sd_b_s = 0, sd_b_w = 0, sd_c = 0;
};

/// @throws std::invalid_argument for a profile that is not in OdometryConfig.
OdometryNoise odometry_noise(const std::string& profile);

/// Integrates what the odometer counts, from (0, 0, 0).
class NoisyOdometry {
 public:
  NoisyOdometry(const OdometryNoise& noise, std::uint64_t seed);
  /// The wheels rolled `distance_m` and would have turned the robot by `turn_rad`, without slip.
  void advance(double distance_m, double turn_rad);
  const Pose2& T_odom_base() const { return T_odom_base_; }
  double counted_turn_rad() const { return counted_turn_rad_; }  ///< of the last advance

 private:
  OdometryNoise noise_;
  RandomStream random_;
  double b_s_, b_w_, c_;
  Pose2 T_odom_base_;
  double counted_turn_rad_ = 0;
};

}  // namespace modslam
