// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/scan_source.hpp"

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/scan/deskew.hpp"

namespace modslam {
namespace {

constexpr std::size_t kMaxWaiting = 200;

}  // namespace

ScanSource::ScanSource(Bus& bus, const std::string& pose_channel,
                       std::function<void(const Scan&, const Pose2&)> on_scan)
    : bus_(bus), channel_(pose_channel), on_scan_(std::move(on_scan)) {
  bus.subscribe<sensor_info_t>(channel::kSensorInfo, [this](const sensor_info_t& m) {
    if (m.sensor == channel::kLaser) sensor_ = to_sensor_info(m);
  });
  bus.subscribe<bot_core::pose_t>(pose_channel, [this](const bot_core::pose_t& m) {
    const TimedPose pose = to_timed_pose(m);
    bus_.saw_utime(pose.utime);
    odometry_.add(pose.utime, pose.pose);
    hand_on_ready();
  });
  bus.subscribe<bot_core::planar_lidar_t>(channel::kLaser, [this](const bot_core::planar_lidar_t& m) {
    waiting_.push_back(to_scan(m, &unusable_ranges_));
    bus_.saw_utime(m.utime);
    hand_on_ready();
  });
}

void ScanSource::hand_on_ready() {
  while (!waiting_.empty()) {
    if (const auto pose = odometry_.at(waiting_.front().utime)) {
      hand_on(*pose);
      continue;
    }
    if (bus_.awaits(channel_)) return;  // it is being repaired
    const bool patience_ends = waiting_.size() > kMaxWaiting ||
                               waiting_.back().utime - waiting_.front().utime > kPatience_us ||
                               (!odometry_.empty() && odometry_.newest_utime() > waiting_.front().utime);
    if (!patience_ends) return;
    if (asked_for_utime_ != waiting_.front().utime) {  // before it goes without: was the newest odometry lost?
      asked_for_utime_ = waiting_.front().utime;
      bus_.suspect(channel_);
      if (bus_.awaits(channel_)) return;
    }
    ++without_odometry_;
    hand_on(odometry_.newest().value_or(Pose2()));
  }
}

void ScanSource::hand_on(const Pose2& T_odom_base) {
  Scan scan = std::move(waiting_.front());
  waiting_.pop_front();
  if (sensor_.sweep_s > 0)
    if (const auto T_last_first = odometry_.during(scan.utime, sensor_.sweep_s)) scan = deskew(scan, sensor_, *T_last_first);
  ++scans_;
  on_scan_(scan, T_odom_base);
}

void ScanSource::flush() {
  while (!waiting_.empty()) {
    ++without_odometry_;
    hand_on(odometry_.newest().value_or(Pose2()));
  }
}

}  // namespace modslam
