// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/tick_log.hpp"

#include "common/formats/text_log.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

/// One line with `beams` ranges of 1.5 m, the first missing.
std::string ticks(std::int64_t utime, std::int64_t left, std::int64_t right, int beams = 682) {
  std::string line = std::to_string(utime) + " 7 " + std::to_string(left) + " " + std::to_string(right);
  for (int k = 0; k < 20; ++k) line += " 0";
  for (int k = 0; k < beams; ++k) line += k == 0 ? " 0" : " 1500";
  return line + "\n";
}

constexpr double kTurn_m = 2 * kPi * 0.077;  // of a wheel

}  // namespace

TEST_CASE("wheel ticks add up: a turn of both wheels drives ahead, opposite turns spin on the spot", "[formats]") {
  const Recording r = read_text_log(ticks(1'000'000, 500, 900) + ticks(1'100'000, 2500, 2900) + ticks(1'200'000, 1500, 3900));
  REQUIRE(r.scans.size() == 3);
  CHECK_THAT(r.scans[0].T_odom_base, IsNear({0, 0, 0}, 0, 0));
  CHECK_THAT(r.scans[1].T_odom_base, IsNear({kTurn_m, 0, 0}, 1e-12, 1e-12));
  CHECK_THAT(r.scans[2].T_odom_base, IsNear({kTurn_m, 0, kTurn_m / 2 / 0.165}, 1e-12, 1e-12));
  CHECK(r.scans[2].scan.utime == 1'200'000);
  REQUIRE(r.T_base_laser.has_value());
  CHECK(r.T_base_laser->x == Approx(0.145));
  CHECK(r.sweep_s == Approx(0.0665).margin(0.0002));  // 240 of 360 degrees at ten turns a second
  CHECK(sensor_of(r, *r.T_base_laser, std::nullopt).sweep_s == r.sweep_s);
}

TEST_CASE("ranges are millimetres from right to left over 240 degrees, 0 is a missing return", "[formats]") {
  const Scan scan = read_text_log(ticks(1, 0, 0)).scans.at(0).scan;
  REQUIRE(scan.ranges_m.size() == 682);
  CHECK(scan.ranges_m[0] == 0);
  CHECK(scan.ranges_m[1] == Approx(1.5));
  CHECK(scan.rad0 * 180 / kPi == Approx(-120).margin(0.5));
  CHECK(scan.bearing_rad(681) * 180 / kPi == Approx(120).margin(0.5));
}

TEST_CASE("a line that was cut is counted and named, and the ticks go on from the line before it", "[formats]") {
  const Recording r = read_text_log(ticks(1, 0, 0) + ticks(2, 700, 700, 100) + ticks(3, 2000, 2000));
  REQUIRE(r.scans.size() == 2);
  CHECK(r.broken_entries == 1);
  CHECK(r.complaints.at(0).find("line 2 has 100 ranges") != std::string::npos);
  CHECK_THAT(r.scans[1].T_odom_base, IsNear({kTurn_m, 0, 0}, 1e-12, 1e-12));
}
