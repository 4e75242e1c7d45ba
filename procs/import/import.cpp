// SPDX-License-Identifier: BSD-3-Clause
#include "procs/import/import.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"

namespace modslam {
namespace {

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string text(const char* format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return line;
}

}  // namespace

ImportedSensor choose_sensor(const Recording& recording, const ImportOptions& options) {
  ImportedSensor chosen;
  chosen.no_return_m = options.no_return_m ? options.no_return_m : find_no_return(recording);
  std::optional<Pose2> mount = options.T_base_laser;
  chosen.mount_source = "as given";
  if (!mount) {
    mount = find_mount(recording);
    chosen.mount_source = mount ? "as the file states" : "assumed, the file does not say";
  }
  chosen.sensor = sensor_of(recording, mount.value_or(Pose2()), chosen.no_return_m);
  return chosen;
}

void write_log(const Recording& recording, const SensorInfo& sensor, LogWriter& log) {
  constexpr std::int64_t kSensorInfoEvery_us = 5'000'000;
  std::int64_t log_utime = 0, sensor_info_utime = 0;
  bool first = true;
  for (const RecordedScan& recorded : recording.scans) {
    const std::int64_t utime = recorded.scan.utime;
    log_utime = first ? utime : std::max(log_utime, utime);
    if (first || log_utime - sensor_info_utime >= kSensorInfoEvery_us) {
      log.write(log_utime, channel::kSensorInfo, to_message(sensor, utime));
      sensor_info_utime = log_utime;
      first = false;
    }
    log.write(log_utime, channel::kOdometry,
              to_message(TimedPose{utime, recorded.T_odom_base, 0.0}));
    log.write(log_utime, channel::kLaser, to_message(recorded.scan));
  }
}

std::string describe(const Recording& recording, const ImportedSensor& sensor) {
  const RecordingSummary s = summarize(recording);
  const Pose2& mount = sensor.sensor.T_base_laser;
  std::string beams = std::to_string(s.min_beams);
  if (s.max_beams != s.min_beams) beams += " to " + std::to_string(s.max_beams);
  std::string out = text("%zu scans of %s beams, %.1f s, odometry %.1f m; ", s.scans, beams.c_str(),
                         s.duration_s, s.odometry_m);
  out += text("%lld stamps step back (at most %.3f s), %lld repeat; ",
              static_cast<long long>(s.steps_back), s.largest_step_back_s,
              static_cast<long long>(s.repeated_stamps));
  out += text("%lld entries skipped as broken, %lld negative ranges; ",
              static_cast<long long>(recording.broken_entries),
              static_cast<long long>(recording.negative_ranges));
  out += sensor.no_return_m ? text("no-return value %.2f m, ", *sensor.no_return_m)
                            : "no no-return value but 0, ";
  out += text("range_max_m %.2f; ", sensor.sensor.range_max_m);
  out += text("laser at x %.3f m, y %.3f m, yaw %.4f rad (%s)\n", mount.x, mount.y, mount.heading,
              sensor.mount_source.c_str());
  if (recording.odometry_entries > 0)
    out += text("  %lld wheel poses between the scans left out: each scan carries its own\n",
                static_cast<long long>(recording.odometry_entries));
  for (const std::string& complaint : recording.complaints) out += "  skipped: " + complaint + "\n";
  const auto unsaid =
      recording.broken_entries - static_cast<std::int64_t>(recording.complaints.size());
  if (unsaid > 0) out += "  and " + std::to_string(unsaid) + " more\n";
  return out;
}

}  // namespace modslam
