// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/odometry_noise.hpp"

#include <stdexcept>

#include "common/world/wheel_motion.hpp"

namespace modslam {

OdometryNoise odometry_noise(const std::string& profile) {
  if (profile == "none") return {};
  if (profile == "official") return {0.005, 0.0014, 0.0028, 0.001, 0.001, 0.0};
  if (profile == "raised") return {0.05, 0.03, 0.06, 0.03, 0.05, 0.005};
  throw std::invalid_argument("odometry noise '" + profile +
                              "': expected none, official or raised");
}

NoisyOdometry::NoisyOdometry(const OdometryNoise& noise, std::uint64_t seed)
    : noise_(noise), random_(seed, RandomStreamId::kOdometry) {
  b_s_ = noise_.sd_b_s * random_.normal();
  b_w_ = noise_.sd_b_w * random_.normal();
  c_ = noise_.sd_c * random_.normal();
}

void NoisyOdometry::advance(double distance_m, double turn_rad) {
  const double root_m = std::sqrt(std::abs(distance_m)), root_rad = std::sqrt(std::abs(turn_rad));
  const double n_d = random_.normal(), n_dt = random_.normal(), n_tt = random_.normal();
  const double counted_m = distance_m * (1 + b_s_) + noise_.k_d * root_m * n_d;
  counted_turn_rad_ = turn_rad * (1 + b_w_) + c_ * distance_m + noise_.k_dt * root_m * n_dt +
                      noise_.k_tt * root_rad * n_tt;
  T_odom_base_ = T_odom_base_ * arc_motion(counted_m, counted_turn_rad_);
}

}  // namespace modslam
