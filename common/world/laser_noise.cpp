// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/laser_noise.hpp"

#include <algorithm>
#include <stdexcept>

namespace modslam {
namespace {

constexpr double kDegree = kPi / 180;
constexpr double kUsarsimNoise = 0.001;  // its scanner errs evenly within this share of the range

LaserModel centred(int beams, double field_of_view_rad, double range_min_m, double range_max_m) {
  return {beams, -field_of_view_rad / 2, field_of_view_rad / (beams - 1), range_min_m, range_max_m};
}

/// Always the same number of draws, whatever the range.
double range_error_m(double range_m, const LaserConfig& config, RandomStream& random) {
  const double even = random.uniform(-1, 1), normal = random.normal();
  if (config.noise == "usarsim") return kUsarsimNoise * range_m * even;
  if (config.noise == "gaussian") return (config.sigma_m + config.sigma_per_m * range_m) * normal;
  return 0;
}

}  // namespace

LaserModel laser_model(const std::string& name) {
  if (name == "sick") return centred(181, 180 * kDegree, 0.1, 20);
  if (name == "urg") return centred(228, 240 * kDegree, 0.02, 4);
  if (name == "hokuyo-270") return centred(1081, 270 * kDegree, 0.1, 30);
  throw std::invalid_argument("laser model '" + name + "': expected sick, urg or hokuyo-270");
}

SensorInfo simulated_sensor(const LaserConfig& config) {
  const LaserModel model = laser_model(config.model);
  SensorInfo sensor;
  sensor.T_base_laser = Pose2(config.mount_x_m, config.mount_y_m, config.mount_yaw_rad);
  sensor.range_min_m = model.range_min_m;
  sensor.range_max_m = model.range_max_m;
  sensor.no_return_is_free = config.dropout == 0;  // with dropouts, silence proves nothing
  return sensor;
}

void add_laser_noise(std::vector<float>& ranges_m, const LaserConfig& config,
                     const LaserModel& model, std::uint64_t seed, std::uint64_t sweep) {
  RandomStream random(seed, RandomStreamId::kLaser, sweep);
  const float miss = static_cast<float>(model.range_max_m);
  for (float& range_m : ranges_m) {
    const double error_m = range_error_m(range_m, config, random);
    const bool lost = random.uniform() < config.dropout;
    if (lost || range_m >= miss)
      range_m = miss;
    else
      range_m = std::clamp(static_cast<float>(range_m + error_m), 0.0f, miss);
  }
}

}  // namespace modslam
