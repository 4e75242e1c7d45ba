// SPDX-License-Identifier: BSD-3-Clause
#include "common/scan/deskew.hpp"

#include <algorithm>
#include <limits>

#include "common/matching/scan_matcher.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

constexpr double kSweep_s = 0.1;

SensorInfo turning_laser() {
  SensorInfo sensor = short_laser();
  sensor.sweep_s = kSweep_s;
  sensor.T_base_laser = {0.2, 0, 0};
  return sensor;
}

/// A sweep whose beams are seen one after the other while the robot moves; it ends at T_map_base.
Scan sweep(const Plan& plan, const SensorInfo& sensor, const Pose2& T_map_base, const Pose2& T_last_first, RandomStream* random = nullptr) {
  Scan scan = see(plan, sensor, T_map_base);
  const auto beams = static_cast<double>(scan.ranges_m.size() - 1);
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const Pose2 T_map_laser = T_map_base * interpolate({}, T_last_first, 1 - static_cast<double>(k) / beams) * sensor.T_base_laser;
    const double range_m = cast_ray(plan, T_map_laser.translation(), T_map_laser.heading + scan.bearing_rad(k), sensor.range_max_m);
    scan.ranges_m[k] = static_cast<float>(range_m + (random && range_m < sensor.range_max_m ? 0.01 * random->normal() : 0));
  }
  return scan;
}

/// Median of the differences between two sweeps of the same bearings, over beams that return in both.
double median_difference_m(const Scan& a, const Scan& b, const SensorInfo& sensor) {
  std::vector<double> all;
  for (std::size_t k = 0; k < a.ranges_m.size(); ++k)
    if (is_return(a.ranges_m[k], sensor) && is_return(b.ranges_m[k], sensor)) all.push_back(std::abs(a.ranges_m[k] - b.ranges_m[k]));
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  return all[all.size() / 2];
}

/// Heading error after a turn on the spot of two radians at 1 rad/s, matched with the sweeps as they came or deskewed.
double heading_error(bool deskewed) {
  const SensorInfo sensor = turning_laser();
  RandomStream random(31, RandomStreamId::kLaser);
  ScanMatcher matcher{ScanMatcherConfig(), OdometryModelConfig()};
  Pose2 T(-1, -0.5, 0.1);
  matcher.match(see(furnished_room(), sensor, T, &random), sensor, {});
  const Pose2 start = T;
  const Pose2 T_last_first(-0.03, 0, -0.1);
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    const Pose2 motion(0.02, 0, 0.1);
    T = T * motion;
    const Scan raw = sweep(furnished_room(), sensor, T, T_last_first, &random);
    const ScanMatch match = matcher.match(deskewed ? deskew(raw, sensor, T_last_first) : raw, sensor, motion);
    worst = std::max(worst, std::abs(wrap_angle((start * match.T_track_base).heading - T.heading)));
  }
  return worst;
}

}  // namespace

TEST_CASE("a sweep of a robot that stands stays as it is") {
  const SensorInfo sensor = turning_laser();
  const Scan scan = see(furnished_room(), sensor, {0.5, 0.2, 0.3});
  REQUIRE(deskew(scan, sensor, {}).ranges_m == scan.ranges_m);
}

TEST_CASE("a sweep taken while driving and turning becomes the one seen at once from its end") {
  const SensorInfo sensor = turning_laser();
  for (const Pose2& T_last_first : {Pose2(-0.1, 0, 0), Pose2(0, 0, -0.15), Pose2(0, 0, 0.15), Pose2(-0.08, 0.01, 0.1)}) {
    const Pose2 T_map_base(0.5, 0.2, 0.3);
    const Scan raw = sweep(furnished_room(), sensor, T_map_base, T_last_first), at_once = see(furnished_room(), sensor, T_map_base);
    const double before_m = median_difference_m(raw, at_once, sensor), after_m = median_difference_m(deskew(raw, sensor, T_last_first), at_once, sensor);
    REQUIRE(before_m > 0.015);
    REQUIRE(after_m < 0.003);
  }
}

TEST_CASE("missing returns stay missing, and bearings that no beam looks to any more have none") {
  SensorInfo sensor = turning_laser();
  Scan scan = see(furnished_room(), sensor, {0, 0, 0});
  for (std::size_t k = 100; k < 120; ++k) scan.ranges_m[k] = 0.0F;
  const Scan turned = deskew(scan, sensor, {0, 0, 0.2});
  REQUIRE(turned.ranges_m.size() == scan.ranges_m.size());
  REQUIRE(std::count_if(turned.ranges_m.begin(), turned.ranges_m.end(), [&](float r) { return !is_return(r, sensor); }) >= 20);
  REQUIRE(turned.ranges_m.front() == 0.0F);  // the first beam now looks 0.2 rad further
}

TEST_CASE("empty sweeps, one beam and NaN pass through") {
  const SensorInfo sensor = turning_laser();
  REQUIRE(deskew({}, sensor, {0, 0, 1}).ranges_m.empty());
  Scan scan = see(furnished_room(), sensor, {0, 0, 0});
  for (float& range_m : scan.ranges_m) range_m = std::numeric_limits<float>::quiet_NaN();
  for (const float range_m : deskew(scan, sensor, {0.1, 0, 0.1}).ranges_m) REQUIRE_FALSE(is_return(range_m, sensor));
}

TEST_CASE("a turning robot's heading is matched right once its sweeps are deskewed") {
  REQUIRE(heading_error(false) > 0.02);
  REQUIRE(heading_error(true) < 0.005);
}
