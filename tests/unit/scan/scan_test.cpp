// SPDX-License-Identifier: BSD-3-Clause
#include "common/scan/scan.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace modslam;

TEST_CASE("a beam straight ahead of a laser that sits ahead and looks left ends on the left") {
  SensorInfo sensor;
  sensor.T_base_laser = {0.5, 0, kPi / 2};
  Scan scan;
  scan.ranges_m = {2.0f};
  const auto points = points_base(scan, sensor);
  REQUIRE(points.size() == 1);
  REQUIRE(points[0].p.x() == Approx(0.5));
  REQUIRE(points[0].p.y() == Approx(2.0));
}

TEST_CASE("what is no return becomes no point, and the others keep the number of their beam") {
  SensorInfo sensor;
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 8.0;
  Scan scan;
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  scan.ranges_m = {1.0f, 0.0f, nan, infinite, -1.0f, 8.0f, 0.05f, 7.9f};
  scan.radstep = 0.1;
  const auto points = points_base(scan, sensor);
  REQUIRE(points.size() == 2);
  REQUIRE(points[0].beam == 0);
  REQUIRE(points[1].beam == 7);
  REQUIRE(points[1].bearing_rad == Approx(0.7));
  REQUIRE(points[1].range_m == Approx(7.9));
}

TEST_CASE("an empty scan has no points") { REQUIRE(points_base(Scan(), SensorInfo()).empty()); }
