// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/run_log.hpp"

#include <modslam/pose_estimate_t.hpp>
#include <new>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "common/evaluation/truth.hpp"

namespace modslam {
namespace {

double seconds(std::int64_t utime) { return static_cast<double>(utime) * 1e-6; }

template <class Message>
Message decode(const LogEvent& event) {
  Message message{};
  const int size = static_cast<int>(event.bytes.size());
  if (message.decode(event.bytes.data(), 0, size) != size) throw BadMessage("cannot be decoded");
  return message;
}

/// A sweep that waits for its true place: truth may be logged after it.
struct WaitingScan {
  Scan scan;
  SensorInfo sensor;
};

void place_scans(std::vector<WaitingScan> waiting, RunLog& log) {
  Path when;  // the index rides along as the pose's x
  for (std::size_t i = 0; i < waiting.size(); ++i)
    when.push_back({seconds(waiting[i].scan.utime), Pose2(static_cast<double>(i), 0, 0)});
  for (const PosePair& pair : pair_with_truth(when, log.truth, &log.unplaced_scans)) {
    WaitingScan& w = waiting[static_cast<std::size_t>(pair.T_map_base.x)];
    log.scans.push_back({pair.T_world_base * w.sensor.T_base_laser, std::move(w.scan), w.sensor});
  }
}

}  // namespace

RunLog read_run_log(const std::string& path) {
  RunLog log;
  LogReader reader(path);
  std::vector<WaitingScan> waiting;
  std::optional<SensorInfo> sensor;
  std::size_t scans_before_sensor = 0;
  const auto take = [&](const LogEvent& event) {
    if (event.channel == channel::kGroundTruth) {
      const TimedPose pose = to_timed_pose(decode<bot_core::pose_t>(event));
      log.truth.push_back({seconds(pose.utime), pose.pose});
    } else if (event.channel == channel::kPose) {
      const auto pose = decode<pose_estimate_t>(event);
      log.estimate.push_back({seconds(pose.utime), to_pose(pose.T_map_base)});
    } else if (event.channel == channel::kSensorInfo) {
      const auto info = decode<sensor_info_t>(event);
      if (info.sensor == channel::kLaser) sensor = to_sensor_info(info);
    } else if (event.channel == channel::kLaser) {
      Scan scan = to_scan(decode<bot_core::planar_lidar_t>(event));
      if (sensor)
        waiting.push_back({std::move(scan), *sensor});
      else
        ++scans_before_sensor;
    }
  };
  for (LogEvent event; reader.next(event);) {
    try {
      take(event);
    } catch (const BadMessage&) {
      ++log.bad_messages;
    } catch (const std::length_error&) {  // a wild array length
      ++log.bad_messages;
    } catch (const std::bad_alloc&) {
      ++log.bad_messages;
    }
  }
  place_scans(std::move(waiting), log);
  log.unplaced_scans += scans_before_sensor;
  log.damage = reader.damage();
  return log;
}

}  // namespace modslam
