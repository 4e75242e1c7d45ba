// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/conversions.hpp"

#include <cmath>

#include "common/bus/bus.hpp"

namespace modslam {
namespace {

double finite(double value, const char* what) {
  if (!std::isfinite(value)) throw BadMessage(std::string(what) + " is not finite");
  return value;
}

double placed(double metres, const char* what) {
  if (!(std::abs(metres) < 1e6)) throw BadMessage(std::string(what) + " is not within 1e6 m");
  return metres;
}

}  // namespace

Scan to_scan(const bot_core::planar_lidar_t& message, std::int64_t* unusable_ranges) {
  if (message.nranges < 1 || message.nranges > 20000)
    throw BadMessage(std::to_string(message.nranges) + " beams: expected 1 to 20000");
  Scan scan;
  scan.utime = message.utime;
  scan.rad0 = finite(message.rad0, "rad0");
  scan.radstep = finite(message.radstep, "radstep");
  if (std::abs(scan.rad0) > 4 * kPi || std::abs(scan.radstep) * message.nranges > 4 * kPi)
    throw BadMessage("beam angles of more than two turns");
  scan.ranges_m = message.ranges;
  for (float& range_m : scan.ranges_m)
    if (!(range_m >= 0.0f) || !std::isfinite(range_m)) {
      if (unusable_ranges) ++*unusable_ranges;
      range_m = 0.0f;
    }
  return scan;
}

bot_core::planar_lidar_t to_message(const Scan& scan) {
  bot_core::planar_lidar_t message{};
  message.utime = scan.utime;
  message.ranges = scan.ranges_m;
  message.nranges = static_cast<std::int32_t>(scan.ranges_m.size());
  message.rad0 = static_cast<float>(scan.rad0);
  message.radstep = static_cast<float>(scan.radstep);
  return message;
}

TimedPose to_timed_pose(const bot_core::pose_t& message) {
  const double w = finite(message.orientation[0], "orientation"), x = finite(message.orientation[1], "orientation"),
               y = finite(message.orientation[2], "orientation"), z = finite(message.orientation[3], "orientation");
  const double norm = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(norm > 0.5 && norm < 2.0)) throw BadMessage("orientation is no unit quaternion");
  const double heading = std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z);
  return {message.utime,
          {placed(message.pos[0], "position"), placed(message.pos[1], "position"), heading},
          std::isfinite(message.rotation_rate[2]) ? message.rotation_rate[2] : 0.0};
}

bot_core::pose_t to_message(const TimedPose& pose) {
  bot_core::pose_t message{};
  message.utime = pose.utime;
  message.pos[0] = pose.pose.x;
  message.pos[1] = pose.pose.y;
  message.orientation[0] = std::cos(pose.pose.heading / 2);
  message.orientation[3] = std::sin(pose.pose.heading / 2);
  message.rotation_rate[2] = pose.yaw_rate;
  return message;
}

SensorInfo to_sensor_info(const sensor_info_t& message) {
  SensorInfo sensor;
  sensor.T_base_laser = to_pose(message.T_base_sensor);
  sensor.range_min_m = finite(message.range_min_m, "range_min_m");
  sensor.range_max_m = finite(message.range_max_m, "range_max_m");
  if (!(sensor.range_min_m >= 0 && sensor.range_max_m > sensor.range_min_m))
    throw BadMessage("range limits leave nothing between them");
  sensor.no_return_is_free = message.no_return_is_free != 0;
  sensor.sweep_s = finite(message.sweep_s, "sweep_s");
  return sensor;
}

sensor_info_t to_message(const SensorInfo& sensor, std::int64_t utime) {
  sensor_info_t message{};
  message.utime = utime;
  message.sensor = "LASER";
  put(message.T_base_sensor, sensor.T_base_laser);
  message.range_min_m = sensor.range_min_m;
  message.range_max_m = sensor.range_max_m;
  message.no_return_is_free = sensor.no_return_is_free;
  message.sweep_s = sensor.sweep_s;
  return message;
}

Pose2 to_pose(const double (&values)[3]) {
  return {placed(values[0], "x"), placed(values[1], "y"), wrap_angle(finite(values[2], "heading"))};
}

void put(double (&values)[3], const Pose2& pose) {
  values[0] = pose.x;
  values[1] = pose.y;
  values[2] = pose.heading;
}

Eigen::Matrix3d to_matrix(const double (&row_major)[9]) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = finite(row_major[i], "matrix");
  return matrix;
}

void put(double (&row_major)[9], const Eigen::Matrix3d& matrix) {
  for (int i = 0; i < 9; ++i) row_major[i] = matrix(i / 3, i % 3);
}

Eigen::Matrix3d to_symmetric(const double (&upper)[6]) {
  Eigen::Matrix3d m;
  for (double value : upper) finite(value, "information");
  m << upper[0], upper[1], upper[2], upper[1], upper[3], upper[4], upper[2], upper[4], upper[5];
  return m;
}

void put(double (&upper)[6], const Eigen::Matrix3d& s) {
  const double values[6] = {s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2)};
  std::copy(values, values + 6, upper);
}

}  // namespace modslam
