// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/scan_matcher.hpp"

#include <set>

#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A matcher that drives through a plan with true or wrong odometry.
struct Drive {
  Drive(const Plan& where, const Pose2& start, std::uint64_t seed) : plan(where), T_map_base(start), random(seed, RandomStreamId::kLaser) {
    first = matcher.match(see(plan, sensor, T_map_base, &random), sensor, {});
  }
  /// @param slip what odometry says beyond the true motion.
  ScanMatch step(const Pose2& motion, const Pose2& slip = {}) {
    T_map_base = T_map_base * motion;
    return matcher.match(see(plan, sensor, T_map_base, &random), sensor, motion * slip);
  }
  Plan plan;
  Pose2 T_map_base;
  RandomStream random;
  SensorInfo sensor = short_laser();
  ScanMatcher matcher{ScanMatcherConfig(), OdometryModelConfig()};
  ScanMatch first;
};

}  // namespace

TEST_CASE("the first scan is called first and starts the track at zero") {
  Drive drive(furnished_room(), {1, 0, 0.4}, 1);
  REQUIRE(drive.first.verdict == Verdict::kFirst);
  REQUIRE_THAT(drive.first.T_track_base, IsNear({}, 0, 0));
}

TEST_CASE("ten metres around a room with slipping odometry end where they should") {
  const Pose2 start(-1, -0.5, 0.1);
  Drive drive(furnished_room(), start, 2);
  ScanMatch match;
  for (int k = 0; k < 100; ++k) {
    match = drive.step({0.05, 0, 0.06}, {0.02, -0.01, 0.02});  // odometry wrong by a third of the way, every step
    REQUIRE(match.verdict == Verdict::kOk);
  }
  REQUIRE_THAT(start * match.T_track_base, IsNear(drive.T_map_base, 0.01, 0.004));
}

TEST_CASE("in a corridor the verdict is degenerate, along the corridor odometry is kept and nothing is claimed") {
  Drive drive(corridor(), {0, 0.2, 0.3}, 3);
  for (int k = 0; k < 20; ++k) {
    const Pose2 slip(0.03, 0, 0);  // odometry drives too far; along the walls nobody can know
    const double heading_rad = drive.T_map_base.heading;
    const ScanMatch match = drive.step({0.10, 0, 0}, slip);
    REQUIRE(match.verdict == Verdict::kDegenerate);
    const Pose2 T_from_to = match.T_from_to;
    const double along = std::cos(heading_rad) * T_from_to.x - std::sin(heading_rad) * T_from_to.y;
    REQUIRE(along == Approx(0.13 * std::cos(heading_rad)).margin(0.004));
    // The direction is along x of the corridor. The track's frame is turned by the start's heading.
    REQUIRE(std::abs(std::sin(match.figures.degenerate_rad + 0.3)) < 0.1);
    const Eigen::Vector3d along_from(std::cos(heading_rad), -std::sin(heading_rad), 0);
    const Eigen::Vector3d across_from(std::sin(heading_rad), std::cos(heading_rad), 0);
    REQUIRE(along_from.dot(match.information * along_from) < 1e-3 * across_from.dot(match.information * across_from));
    REQUIRE(along_from.dot(match.covariance * along_from) > 1e-4);  // as wide as odometry: more than a centimetre
  }
}

TEST_CASE("never a silent failure: 100 jumps in a room that odometry knows nothing of") {
  // The robot is carried up to 0.8 m and 0.6 rad, odometry says it stood still. Right or not believed; never wrong and believed.
  RandomStream where(4, RandomStreamId::kOdometry);
  int right = 0, refused = 0, silent = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Drive drive(furnished_room(), {where.uniform(-1.5, 1.0), where.uniform(-0.8, 1.2), where.uniform(-kPi, kPi)}, 400 + seed);
    const Pose2 carried(where.uniform(-0.55, 0.55), where.uniform(-0.55, 0.55), where.uniform(-0.6, 0.6));
    const Pose2 T_from = drive.T_map_base;
    const ScanMatch match = drive.step(carried, carried.inverse());
    const Pose2 error = between(drive.T_map_base, T_from * match.T_from_to);
    const bool wrong = std::hypot(error.x, error.y) > 0.10 || std::abs(error.heading) > 0.03;
    if (!is_usable(match.verdict)) ++refused;
    else if (wrong) ++silent;
    else ++right;
  }
  std::printf("matcher, 100 jumps without odometry: %d right, %d refused, %d silent\n", right, refused, silent);
  REQUIRE(silent == 0);
  REQUIRE(right > 90);
}

TEST_CASE("a scan of another building is refused, odometry stands in with its wide covariance") {
  Drive drive(furnished_room(), {}, 5);
  Plan elsewhere;
  add_box(elsewhere, -1.1, -7, 9, 1.7);
  elsewhere.push_back({{2, 1}, {7, -6}});
  drive.plan = elsewhere;
  const Pose2 motion(0.1, 0, 0.05);
  const ScanMatch match = drive.step(motion);
  REQUIRE_FALSE(is_usable(match.verdict));
  REQUIRE(match.information.norm() == 0);
  REQUIRE_THAT(match.T_from_to, IsNear(motion, 1e-9, 1e-9));
  REQUIRE(match.covariance(0, 0) > 1e-4);
}

TEST_CASE("after eight refused scans the matcher begins a new piece of map and matches again") {
  Drive drive(furnished_room(), {}, 6);
  Plan elsewhere;
  add_box(elsewhere, -1.1, -7, 9, 1.7);
  drive.plan = elsewhere;
  int refused = 0;
  ScanMatch match = drive.step({});
  while (!is_usable(match.verdict) && refused < 20) {
    ++refused;
    match = drive.step({});
  }
  REQUIRE(refused == 8);
  REQUIRE_THAT(match.T_track_base, IsNear({}, 0.01, 0.01));
}

TEST_CASE("empty scans and scans of one point are refused, and matching goes on after them") {
  Drive drive(furnished_room(), {}, 7);
  Scan one;
  one.ranges_m = {2.0f};
  for (const Scan& scan : {Scan(), one}) {
    const ScanMatch match = drive.matcher.match(scan, drive.sensor, {0.01, 0, 0});
    REQUIRE(match.verdict == Verdict::kFailed);
    REQUIRE(match.information.norm() == 0);
    REQUIRE_THAT(match.T_from_to, IsNear({0.01, 0, 0}, 1e-9, 1e-9));
  }
  REQUIRE(drive.step({0.05, 0, 0}).verdict == Verdict::kOk);
}

TEST_CASE("a matcher whose first scan was empty starts when there is something to see") {
  ScanMatcher matcher{ScanMatcherConfig(), OdometryModelConfig()};
  const SensorInfo sensor = short_laser();
  RandomStream random(8, RandomStreamId::kLaser);
  REQUIRE(matcher.match(Scan(), sensor, {}).verdict == Verdict::kFirst);
  int usable = 0;
  for (int k = 0; k < 30; ++k) usable += is_usable(matcher.match(see(furnished_room(), sensor, {}, &random), sensor, {}).verdict);
  REQUIRE(usable >= 20);
}

TEST_CASE("every verdict has a name of its own and only ok and degenerate may become edges") {
  std::set<std::string> names;
  int usable = 0;
  for (std::int8_t v = 0; v <= 7; ++v) {
    names.insert(to_string(static_cast<Verdict>(v)));
    usable += is_usable(static_cast<Verdict>(v));
  }
  REQUIRE(names.size() == 8);
  REQUIRE(usable == 2);
}
