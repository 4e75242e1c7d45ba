// SPDX-License-Identifier: BSD-3-Clause
/// to_rawlog LOG.lcm OUT.rawlog: an LCM log as MRPT's programs read it, pairs of an odometry increment and a scan. Stamps are made
/// monotone (1 ms steps at least): MRPT refuses what steps back.
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pose_t.hpp>
#include <cmath>
#include <iostream>
#include <modslam/sensor_info_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "common/motion/odometry_buffer.hpp"

using namespace modslam;

namespace {

template <class Message>
bool decode(const LogEvent& event, Message& message) {
  return message.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())) >= 0;
}

mrpt::obs::CObservation2DRangeScan::Ptr to_mrpt(const Scan& scan, const SensorInfo& sensor, double stamp_s) {
  auto out = mrpt::obs::CObservation2DRangeScan::Create();
  out->timestamp = mrpt::Clock::fromDouble(stamp_s);
  out->sensorLabel = "LASER";
  const auto& mount = sensor.T_base_laser;
  out->sensorPose = mrpt::poses::CPose3D(mount.x, mount.y, 0.2, mount.heading, 0, 0);
  out->rightToLeft = scan.radstep > 0;
  out->aperture = static_cast<float>(std::abs(scan.radstep) * static_cast<double>(scan.ranges_m.size() - 1));
  out->maxRange = static_cast<float>(sensor.range_max_m);
  out->resizeScan(scan.ranges_m.size());
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const bool valid = is_return(scan.ranges_m[k], sensor);
    out->setScanRange(k, valid ? scan.ranges_m[k] : 0.0F);
    out->setScanRangeValidity(k, valid);
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) throw std::runtime_error("to_rawlog LOG.lcm OUT.rawlog");
  OdometryBuffer odometry(1u << 22);
  std::vector<Scan> scans;
  SensorInfo sensor;
  LogReader reader(argv[1]);
  for (LogEvent event; reader.next(event);) {
    bot_core::planar_lidar_t laser{};
    bot_core::pose_t pose{};
    sensor_info_t info{};
    if (event.channel == channel::kLaser && decode(event, laser)) scans.push_back(to_scan(laser));
    else if (event.channel == channel::kSensorInfo && decode(event, info)) sensor = to_sensor_info(info);
    else if (event.channel == channel::kOdometry && decode(event, pose)) odometry.add(to_timed_pose(pose).utime, to_timed_pose(pose).pose);
  }
  mrpt::io::CFileGZOutputStream file(argv[2]);
  auto archive = mrpt::serialization::archiveFrom(file);
  Pose2 last;
  double stamp_s = scans.empty() ? 0 : 1e-6 * static_cast<double>(scans.front().utime);
  mrpt::obs::CActionRobotMovement2D::TMotionModelOptions model;
  model.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
  for (const Scan& scan : scans) {
    stamp_s = std::max(stamp_s + 1e-3, 1e-6 * static_cast<double>(scan.utime));
    const auto now = odometry.at(scan.utime);
    const Pose2 here = now ? *now : odometry.newest() ? *odometry.newest() : last;
    const Pose2 moved = &scan == &scans.front() ? Pose2() : between(last, here);
    last = here;
    mrpt::obs::CActionRobotMovement2D action;
    action.timestamp = mrpt::Clock::fromDouble(stamp_s);
    action.computeFromOdometry(mrpt::poses::CPose2D(moved.x, moved.y, moved.heading), model);
    mrpt::obs::CActionCollection actions;
    actions.insert(action);
    mrpt::obs::CSensoryFrame frame;
    frame.insert(to_mrpt(scan, sensor, stamp_s));
    archive << actions << frame;
  }
  std::cout << scans.size() << " scans\n";
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << std::endl;
  return 1;
}
