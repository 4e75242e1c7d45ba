// SPDX-License-Identifier: BSD-3-Clause
/// @file Pairs every scan with the odometry of its own time, in order of arrival, and keeps the sensor's mount.
///
/// A scan waits until odometry covers its stamp; when odometry stays away (more than kPatience_us of newer scans, or more than kMaxWaiting
/// scans) it is handed on with the newest pose there is, and counted. A sweep that took its time is handed on as seen at once (common/scan/deskew.hpp).
#pragma once
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pose_t.hpp>
#include <deque>
#include <functional>
#include <modslam/sensor_info_t.hpp>

#include "common/bus/bus.hpp"
#include "common/motion/odometry_buffer.hpp"
#include "common/scan/scan.hpp"

namespace modslam {

class ScanSource {
 public:
  static constexpr std::int64_t kPatience_us = 500'000;

  /// `on_scan` gets each scan with the pose at its time. Subscribes LASER, SENSOR_INFO and `pose_channel` (ODOMETRY or another
  /// channel of pose_t).
  ScanSource(Bus& bus, const std::string& pose_channel,
             std::function<void(const Scan&, const Pose2& T_odom_base)> on_scan);

  /// For a process that goes on after a restart: the mount that was in force.
  void set_sensor(const SensorInfo& sensor) { sensor_ = sensor; }
  /// Hands on every scan that still waits: no more odometry will come.
  void flush();
  const SensorInfo& sensor() const { return sensor_; }
  std::int64_t scans() const { return scans_; }
  std::int64_t without_odometry() const { return without_odometry_; }
  std::int64_t unusable_ranges() const { return unusable_ranges_; }
  std::int64_t backward_steps() const { return odometry_.backward_steps(); }

 private:
  void hand_on_ready();
  void hand_on(const Pose2& T_odom_base);

  Bus& bus_;
  std::string channel_;
  std::function<void(const Scan&, const Pose2&)> on_scan_;
  SensorInfo sensor_;
  OdometryBuffer odometry_;
  std::deque<Scan> waiting_;
  std::int64_t asked_for_utime_ = -1;  ///< the scan for which odometry was asked again
  std::int64_t scans_ = 0, without_odometry_ = 0, unusable_ranges_ = 0;
};

}  // namespace modslam
