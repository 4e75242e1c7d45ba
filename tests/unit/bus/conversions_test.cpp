// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/conversions.hpp"

#include <limits>

#include "common/bus/bus.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using Catch::Matchers::Contains;

namespace {
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();
}

TEST_CASE("scans, poses and mounts come back from messages as they went in") {
  Scan scan;
  scan.utime = 17;
  scan.ranges_m = {1, 2.5f, 80};
  scan.rad0 = -1.5;
  scan.radstep = 0.25;
  const Scan back = to_scan(to_message(scan));
  REQUIRE(back.utime == 17);
  REQUIRE(back.ranges_m == scan.ranges_m);
  REQUIRE(back.bearing_rad(2) == Approx(-1.0));

  std::mt19937_64 random(151);
  for (int k = 0; k < 100; ++k) {
    TimedPose pose;
    pose.utime = k;
    pose.pose = random_pose(random, 50);
    pose.yaw_rate = 0.3;
    const TimedPose again = to_timed_pose(to_message(pose));
    REQUIRE_THAT(again.pose, IsNear(pose.pose, 1e-12, 1e-9));
    REQUIRE(again.yaw_rate == 0.3);
  }

  SensorInfo sensor;
  sensor.T_base_laser = {0.1, -0.2, 3.0};
  sensor.range_max_m = 30;
  sensor.no_return_is_free = true;
  sensor.sweep_s = 0.02;
  const SensorInfo mount = to_sensor_info(to_message(sensor, 5));
  REQUIRE_THAT(mount.T_base_laser, IsNear(sensor.T_base_laser, 0, 1e-12));
  REQUIRE(mount.range_max_m == 30);
  REQUIRE(mount.no_return_is_free);
  REQUIRE(mount.sweep_s == 0.02);
}

TEST_CASE("ranges that cannot be are missing returns, and counted") {
  bot_core::planar_lidar_t message{};
  message.ranges = {1.0f, -2.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 0.0f};
  message.nranges = 5;
  std::int64_t unusable = 0;
  REQUIRE(to_scan(message, &unusable).ranges_m == std::vector<float>{1, 0, 0, 0, 0});
  REQUIRE(unusable == 3);
}

TEST_CASE("scans without beams, with absurd many or absurd angles are refused") {
  bot_core::planar_lidar_t message{};
  REQUIRE_THROWS_WITH(to_scan(message), Contains("0 beams"));
  message.nranges = 20001;
  message.ranges.assign(20001, 1.0f);
  REQUIRE_THROWS_AS(to_scan(message), BadMessage);
  message.nranges = 2;
  message.ranges = {1, 1};
  message.radstep = std::numeric_limits<float>::quiet_NaN();
  REQUIRE_THROWS_WITH(to_scan(message), Contains("radstep is not finite"));
  message.radstep = 10;
  REQUIRE_THROWS_WITH(to_scan(message), Contains("two turns"));
}

TEST_CASE("poses with a broken quaternion or a wild place are refused, an unnormalised one is read") {
  bot_core::pose_t message = to_message(TimedPose{1, {1, 2, 0.5}, 0});
  for (double& q : message.orientation) q *= 1.5;
  REQUIRE_THAT(to_timed_pose(message).pose, IsNear({1, 2, 0.5}, 0, 1e-9));
  message.pos[0] = 2e6;
  REQUIRE_THROWS_AS(to_timed_pose(message), BadMessage);
  message.pos[0] = kNaN;
  REQUIRE_THROWS_AS(to_timed_pose(message), BadMessage);
  message.pos[0] = 0;
  for (double& q : message.orientation) q = 0;
  REQUIRE_THROWS_WITH(to_timed_pose(message), Contains("no unit quaternion"));
  message.orientation[0] = kNaN;
  REQUIRE_THROWS_AS(to_timed_pose(message), BadMessage);
}

TEST_CASE("range limits that leave nothing and values that are no numbers are refused") {
  sensor_info_t message = to_message(SensorInfo(), 0);
  message.range_max_m = message.range_min_m;
  REQUIRE_THROWS_WITH(to_sensor_info(message), Contains("leave nothing"));
  message.range_max_m = kInfinite;
  REQUIRE_THROWS_AS(to_sensor_info(message), BadMessage);
}

TEST_CASE("matrices go through whole and as upper triangle") {
  Eigen::Matrix3d m;
  m << 1, 2, 3, 2, 5, 6, 3, 6, 9;
  double nine[9], six[6];
  put(nine, m);
  put(six, m);
  REQUIRE(to_matrix(nine) == m);
  REQUIRE(to_symmetric(six) == m);
  nine[4] = six[4] = kNaN;
  REQUIRE_THROWS_AS(to_matrix(nine), BadMessage);
  REQUIRE_THROWS_AS(to_symmetric(six), BadMessage);
}
