// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/landmarks.hpp"

#include <deque>

#include "common/matching/scan_matcher.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

OrientedPoint isolated(double x, double y) { return {{x, y}, Eigen::Vector2d::Zero(), 1e-4F, 0.0F}; }

/// Keyframes that stand still and see these points, each time with a little noise; those of `strewn` jump along x by up to half a metre.
struct Sight {
  Sight(const std::vector<Eigen::Vector2d>& things, const std::vector<Eigen::Vector2d>& strewn, int times) : random(11, RandomStreamId::kLaser) {
    for (int k = 0; k < times; ++k) {
      Keyframe keyframe;
      for (const Eigen::Vector2d& p : things) keyframe.points_base.push_back(isolated(p.x() + 0.01 * random.normal(), p.y() + 0.01 * random.normal()));
      for (const Eigen::Vector2d& p : strewn) keyframe.points_base.push_back(isolated(p.x() + random.uniform(-0.5, 0.5), p.y() + 0.01 * random.normal()));
      kept.push_back(keyframe);
    }
    std::vector<const Keyframe*> all;
    for (const Keyframe& keyframe : kept) all.push_back(&keyframe);
    landmarks.build(all);
  }
  RandomStream random;
  std::deque<Keyframe> kept;
  Landmarks landmarks;
};

const std::vector<Eigen::Vector2d> kPosts = {{3, 1}, {4.3, -1}, {6.1, 1}};

/// A corridor with a post of a hand's breadth on the walls here and there, always on the far side of what gives a normal.
Plan corridor_with_posts() {
  Plan plan = corridor();
  for (const double x : {4.1, 7.6, 9.9, 13.4, 17.1, 19.5}) add_box(plan, x, 1.0, x + 0.12, 1.25);
  for (const double x : {5.2, 8.3, 12.0, 15.3, 18.8}) add_box(plan, x, -1.25, x + 0.12, -1.0);
  return plan;
}

struct DriveResult {
  double error_m;      ///< along the corridor at the end
  int claimed_along;  ///< matches that say they know the way along
};

/// Ten metres along a corridor with an odometer that says a tenth too much. A laser of five degrees a beam would miss the posts; this one
/// has one degree and a range of 10 m.
DriveResult drive_along(const Plan& plan, const std::function<void(Plan&, double way_m)>& move_things = {}) {
  RandomStream random(21, RandomStreamId::kLaser);
  SensorInfo sensor = short_laser();
  ScanMatcher matcher{ScanMatcherConfig(), OdometryModelConfig()};
  Plan now = plan;
  Pose2 T(0, 0.1, 0);
  matcher.match(see(now, sensor, T, &random), sensor, {});
  DriveResult result{0, 0};
  ScanMatch match;
  for (int k = 0; k < 100; ++k) {
    T.x += 0.1;
    if (move_things) {
      now = plan;
      move_things(now, T.x);
    }
    match = matcher.match(see(now, sensor, T, &random), sensor, {0.11, 0, 0});
    result.claimed_along += match.information(0, 0) > 1 / (0.1 * 0.1);
  }
  result.error_m = match.T_track_base.x - T.x;
  return result;
}

}  // namespace

TEST_CASE("points that many keyframes left in one place are a pile with its mean, scatter and witnesses") {
  const Sight sight(kPosts, {}, 10);
  const std::optional<Pile> pile = sight.landmarks.pile_at({3.05, 0.98}, 0.1);
  REQUIRE(pile.has_value());
  REQUIRE((pile->mean - kPosts[0]).norm() < 0.01);
  REQUIRE(pile->points == 10);
  REQUIRE(pile->keyframes == 10);
  REQUIRE(pile->scatter.trace() < 2 * 0.02 * 0.02);
  REQUIRE_FALSE(sight.landmarks.pile_at({3.05, 0.7}, 0.1).has_value());
}

TEST_CASE("what only three keyframes saw is no landmark yet, and nothing is none") {
  REQUIRE_FALSE(Sight(kPosts, {}, 3).landmarks.pile_at(kPosts[0], 0.1).has_value());
  REQUIRE_FALSE(Landmarks().pile_at({0, 0}, 0.1).has_value());
  REQUIRE(fit_along({}, Landmarks(), {}, {1, 0}, 0.05).information == 0);
}

TEST_CASE("a scan is moved along the corridor until its points stand on their piles, and the guess still counts") {
  const Sight sight(kPosts, {}, 20);
  std::vector<OrientedPoint> scan;
  for (const Eigen::Vector2d& p : kPosts) scan.push_back(isolated(p.x() - 0.04, p.y()));
  const LandmarkFit sure = fit_along(scan, sight.landmarks, {}, {1, 0}, 0.05);
  REQUIRE(sure.points == 3);
  REQUIRE(sure.shift_m == Approx(0.04).margin(0.008));
  REQUIRE(sure.information > 3 / (0.03 * 0.03));
  const LandmarkFit doubted = fit_along(scan, sight.landmarks, {}, {1, 0}, 0.025);
  REQUIRE(doubted.shift_m < sure.shift_m);
}

TEST_CASE("points strewn along a wall say nothing of the way along it, however often it was seen") {
  const Sight sight({}, {{2, 1}, {2.5, 1}, {3, 1}, {3.5, 1}, {2, -1}, {3, -1}}, 60);
  std::vector<OrientedPoint> scan;
  for (double x = 1.8; x < 3.6; x += 0.2) scan.push_back(isolated(x, 1)), scan.push_back(isolated(x, -1));
  REQUIRE(fit_along(scan, sight.landmarks, {}, {1, 0}, 0.05).information == 0);
}

TEST_CASE("where another shift fits nearly as well nothing is claimed") {
  // Posts every 0.4 m: wheels that slipped by one spacing would look the same.
  std::vector<Eigen::Vector2d> fence;
  for (int k = 0; k < 10; ++k) fence.push_back({2 + 0.4 * k, 1});
  const Sight sight(fence, {}, 20);
  std::vector<OrientedPoint> scan;
  for (const Eigen::Vector2d& p : fence) scan.push_back(isolated(p.x() - 0.03, p.y()));
  REQUIRE(fit_along(scan, sight.landmarks, {}, {1, 0}, 0.05).information == 0);
}

TEST_CASE("posts along a corridor keep the matcher in place where bare walls let it drift with the wheels") {
  const DriveResult bare = drive_along(corridor()), posts = drive_along(corridor_with_posts());
  REQUIRE(bare.error_m > 0.8);
  REQUIRE(bare.claimed_along == 0);
  REQUIRE(std::abs(posts.error_m) < 0.1);
  REQUIRE(posts.claimed_along > 50);
}

TEST_CASE("people who walk along with the robot are no landmarks") {
  const DriveResult walked = drive_along(corridor(), [](Plan& plan, double way_m) {
    for (const double ahead : {2.5, 3.4, 5.1, 6.3}) add_box(plan, way_m + ahead, 0.5, way_m + ahead + 0.1, 0.6);
  });
  REQUIRE(walked.error_m > 0.8);
  REQUIRE(walked.claimed_along < 5);
}
