// SPDX-License-Identifier: BSD-3-Clause
#include "common/motion/odometry_buffer.hpp"

#include "tests/support/matchers.hpp"

using namespace modslam;

TEST_CASE("between two poses the robot was in between, the short way round") {
  OdometryBuffer buffer;
  buffer.add(1000, {0, 0, kPi - 0.1});
  buffer.add(2000, {1, 2, -kPi + 0.1});
  REQUIRE_THAT(*buffer.at(1500), IsNear({0.5, 1, kPi}, 1e-12, 1e-12));
  REQUIRE_THAT(*buffer.at(1000), IsNear({0, 0, kPi - 0.1}, 1e-12, 1e-12));
  REQUIRE_THAT(*buffer.at(2000), IsNear({1, 2, -kPi + 0.1}, 1e-12, 1e-12));
}

TEST_CASE("a time that odometry does not cover has no pose") {
  OdometryBuffer buffer;
  REQUIRE(buffer.empty());
  REQUIRE_FALSE(buffer.at(5));
  REQUIRE_FALSE(buffer.newest());
  buffer.add(1000, {1, 0, 0});
  REQUIRE_FALSE(buffer.at(999));
  REQUIRE_FALSE(buffer.at(1001));
  REQUIRE(buffer.newest_utime() == 1000);
}

TEST_CASE("stamps that step back are counted, and a time is looked up from the newest end") {
  OdometryBuffer buffer;
  buffer.add(1000, {1, 0, 0});
  buffer.add(3000, {3, 0, 0});
  buffer.add(2000, {30, 0, 0});  // the clock was set back; the robot was not
  buffer.add(4000, {50, 0, 0});
  REQUIRE(buffer.backward_steps() == 1);
  REQUIRE_THAT(*buffer.at(3000), IsNear({40, 0, 0}, 1e-9, 0));
  REQUIRE_THAT(*buffer.at(1500), IsNear({1.5, 0, 0}, 1e-9, 0));
}

TEST_CASE("the buffer forgets the oldest, not the newest") {
  OdometryBuffer buffer;
  for (int k = 0; k <= 1000; ++k) buffer.add(k, {static_cast<double>(k), 0, 0});
  REQUIRE_FALSE(buffer.at(10));
  REQUIRE(buffer.at(990)->x == Approx(990));
}
