// SPDX-License-Identifier: BSD-3-Clause
/// @file Between messages and the types of common/. Every check of foreign data is here: finite, sizes, bounds.
#pragma once
#include <array>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pose_t.hpp>
#include <modslam/sensor_info_t.hpp>

#include "common/geometry/pose2.hpp"
#include "common/scan/scan.hpp"

namespace modslam {

/// A planar pose with its time, from a pose_t.
struct TimedPose {
  std::int64_t utime = 0;
  Pose2 pose;
  double yaw_rate = 0;  ///< [rad/s]
};

/// @throws BadMessage on sizes that disagree, non-finite geometry, no beams or more than 20000.
/// NaN, infinite and negative ranges become 0 (a missing return); *negative counts them when given.
Scan to_scan(const bot_core::planar_lidar_t& message, std::int64_t* unusable_ranges = nullptr);
bot_core::planar_lidar_t to_message(const Scan& scan);

/// @throws BadMessage on non-finite values, a quaternion that is no rotation, a place beyond 1e6 m.
TimedPose to_timed_pose(const bot_core::pose_t& message);
bot_core::pose_t to_message(const TimedPose& pose);

/// @throws BadMessage on non-finite values or range limits that exclude everything.
SensorInfo to_sensor_info(const sensor_info_t& message);
sensor_info_t to_message(const SensorInfo& sensor, std::int64_t utime);

/// Poses and matrices as the messages carry them. @throws BadMessage on non-finite values.
Pose2 to_pose(const double (&values)[3]);
void put(double (&values)[3], const Pose2& pose);
Eigen::Matrix3d to_matrix(const double (&row_major)[9]);
void put(double (&row_major)[9], const Eigen::Matrix3d& matrix);
/// Upper triangle xx xy xt yy yt tt of a symmetric matrix.
Eigen::Matrix3d to_symmetric(const double (&upper)[6]);
void put(double (&upper)[6], const Eigen::Matrix3d& symmetric);

}  // namespace modslam
