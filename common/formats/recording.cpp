// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/recording.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace modslam {

RecordingSummary summarize(const Recording& recording) {
  RecordingSummary s;
  s.scans = recording.scans.size();
  if (recording.scans.empty()) return s;
  std::int64_t first = recording.scans.front().scan.utime, last = first;
  s.min_beams = recording.scans.front().scan.ranges_m.size();
  for (std::size_t i = 0; i < recording.scans.size(); ++i) {
    const RecordedScan& now = recording.scans[i];
    first = std::min(first, now.scan.utime);
    last = std::max(last, now.scan.utime);
    s.min_beams = std::min(s.min_beams, now.scan.ranges_m.size());
    s.max_beams = std::max(s.max_beams, now.scan.ranges_m.size());
    if (i == 0) continue;
    const RecordedScan& before = recording.scans[i - 1];
    s.odometry_m += distance(before.T_odom_base, now.T_odom_base);
    const double step_s = static_cast<double>(now.scan.utime - before.scan.utime) * 1e-6;
    if (step_s < 0) ++s.steps_back;
    if (now.scan.utime == before.scan.utime) ++s.repeated_stamps;
    s.largest_step_back_s = std::max(s.largest_step_back_s, -step_s);
  }
  s.duration_s = static_cast<double>(last - first) * 1e-6;
  return s;
}

std::optional<double> find_no_return(const Recording& recording) {
  std::map<std::int64_t, std::int64_t> count_of_mm;
  std::int64_t readings = 0;
  for (const RecordedScan& recorded : recording.scans)
    for (const float range_m : recorded.scan.ranges_m)
      if (range_m > 0) ++count_of_mm[std::llround(range_m * 1000.0)], ++readings;
  // At that value or just below it (one laser's error codes lie close together) there are many
  // readings, beyond it next to none, and in the two metres under it far fewer: honest ranges thin
  // out gradually.
  const std::int64_t often = std::max<std::int64_t>(10, readings / 10000);
  std::int64_t beyond = 0;
  for (auto value = count_of_mm.rbegin(); value != count_of_mm.rend(); ++value) {
    const std::int64_t mm = value->first, edge_mm = mm - mm / 200;
    if (value->second < often) {
      beyond += value->second;
      continue;
    }
    const auto count = [&](std::int64_t low_mm, std::int64_t high_mm) {
      std::int64_t sum = 0;
      for (auto it = count_of_mm.lower_bound(low_mm);
           it != count_of_mm.end() && it->first < high_mm; ++it)
        sum += it->second;
      return sum;
    };
    const std::int64_t at = count(edge_mm, mm + 1), below = count(edge_mm - 2000, edge_mm);
    if (10 * below < at && 100 * beyond < at) return static_cast<double>(mm) / 1000.0;
    return std::nullopt;
  }
  return std::nullopt;
}

std::optional<Pose2> find_mount(const Recording& recording) {
  if (recording.T_base_laser) return recording.T_base_laser;
  std::optional<Pose2> mount;
  for (const RecordedScan& recorded : recording.scans) {
    if (!recorded.T_odom_laser) return std::nullopt;
    const Pose2 seen = between(recorded.T_odom_base, *recorded.T_odom_laser);
    if (!mount) mount = seen;
    // A file that corrected one of the two poses gives a difference that wanders: not a mount.
    if (distance(*mount, seen) > 0.01 || std::abs(wrap_angle(seen.heading - mount->heading)) > 0.01)
      return std::nullopt;
  }
  return mount;
}

SensorInfo sensor_of(const Recording& recording, const Pose2& T_base_laser,
                     std::optional<double> no_return_m) {
  SensorInfo sensor;
  sensor.T_base_laser = T_base_laser;
  sensor.range_min_m = 0.02;
  sensor.sweep_s = recording.sweep_s;
  sensor.no_return_is_free =
      false;  // a foreign log does not say whether nothing was there or nothing came back
  float longest_m = 0;
  for (const RecordedScan& recorded : recording.scans)
    for (const float range_m : recorded.scan.ranges_m) longest_m = std::max(longest_m, range_m);
  sensor.range_max_m = no_return_m ? *no_return_m * 0.995 : longest_m + 0.01;
  if (recording.range_limit_m > sensor.range_min_m)
    sensor.range_max_m = std::min(sensor.range_max_m, recording.range_limit_m);
  sensor.range_max_m = std::max(sensor.range_max_m, 2 * sensor.range_min_m);
  return sensor;
}

}  // namespace modslam
