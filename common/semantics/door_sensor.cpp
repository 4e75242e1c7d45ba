// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/door_sensor.hpp"

#include <cmath>

namespace modslam {
namespace {

struct Beam {
  double range_m, bearing_rad;
};

/// Returns, and what is known to be empty as a beam of full length, by bearing.
std::vector<Beam> usable_beams(const Scan& scan, const SensorInfo& sensor) {
  std::vector<Beam> beams;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (is_return(scan.ranges_m[i], sensor))
      beams.push_back({scan.ranges_m[i], scan.bearing_rad(i)});
    else if (sensor.no_return_is_free)
      beams.push_back({sensor.range_max_m, scan.bearing_rad(i)});
  }
  return beams;
}

Eigen::Vector2d place(const Pose2& T_base_laser, const Beam& beam) {
  return T_base_laser * Eigen::Vector2d(beam.range_m * std::cos(beam.bearing_rad),
                                        beam.range_m * std::sin(beam.bearing_rad));
}

}  // namespace

std::vector<JambPair> sense_doors(const Scan& scan, const SensorInfo& sensor, double depth_m,
                                  double min_width_m, double max_width_m, double range_limit_m) {
  const std::vector<Beam> beams = usable_beams(scan, sensor);
  const int n = static_cast<int>(beams.size());
  std::vector<JambPair> pairs;
  for (const int step : {1, -1}) {
    for (int i = step > 0 ? 0 : n - 1; i + step >= 0 && i + step < n; i += step) {
      const Beam& prev = beams[static_cast<std::size_t>(i)];
      if (prev.range_m > range_limit_m ||
          beams[static_cast<std::size_t>(i + step)].range_m - prev.range_m < depth_m)
        continue;
      int j = i + step;
      while (j >= 0 && j < n &&
             beams[static_cast<std::size_t>(j)].range_m - prev.range_m >= depth_m)
        j += step;
      if (j < 0 || j >= n) continue;
      const Beam& last = beams[static_cast<std::size_t>(j)];
      const double angle = std::abs(last.bearing_rad - prev.bearing_rad);
      // Cosine theorem.
      const double width_m = std::sqrt(prev.range_m * prev.range_m + last.range_m * last.range_m -
                                       2 * prev.range_m * last.range_m * std::cos(angle));
      if (width_m >= min_width_m && width_m <= max_width_m)
        pairs.push_back({place(sensor.T_base_laser, prev), place(sensor.T_base_laser, last)});
    }
  }
  return pairs;
}

}  // namespace modslam
