// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/ins_noise.hpp"

#include <stdexcept>

namespace modslam {
namespace {

constexpr double kStartBias_rad_s = 0.001;
constexpr double kBiasWalk_rad_s = 2e-5;    // per sqrt(s)
constexpr double kWhite_rad = 0.002;        // per sqrt(s)
constexpr double kUsarsimPrecision = 1000;  // its INS draws the mean from +-0.5 / precision^2
constexpr double kUsarsimSigma = 0.05;

}  // namespace

NoisyIns::NoisyIns(const std::string& noise, std::uint64_t seed)
    : random_(seed, RandomStreamId::kIns) {
  if (noise == "none") {
    model_ = Model::kNone;
  } else if (noise == "gyro") {
    model_ = Model::kGyro;
    bias_rad_s_ = kStartBias_rad_s * random_.normal();
  } else if (noise == "usarsim") {
    model_ = Model::kUsarsim;
    mean_ = random_.uniform(-0.5, 0.5) / (kUsarsimPrecision * kUsarsimPrecision);
  } else {
    throw std::invalid_argument("INS noise '" + noise + "': expected none, gyro or usarsim");
  }
}

void NoisyIns::advance(double turn_rad, double dt_s) {
  const double measured_rad = measured_turn_rad(turn_rad, dt_s);
  heading_rad_ = wrap_angle(heading_rad_ + measured_rad);
  yaw_rate_ = measured_rad / dt_s;
}

double NoisyIns::measured_turn_rad(double turn_rad, double dt_s) {
  switch (model_) {
    case Model::kGyro:
      bias_rad_s_ += kBiasWalk_rad_s * std::sqrt(dt_s) * random_.normal();
      return turn_rad + bias_rad_s_ * dt_s + kWhite_rad * std::sqrt(dt_s) * random_.normal();
    case Model::kUsarsim:
      return turn_rad + turn_rad * (mean_ + kUsarsimSigma * random_.normal());
    case Model::kNone:
      break;
  }
  return turn_rad;
}

}  // namespace modslam
