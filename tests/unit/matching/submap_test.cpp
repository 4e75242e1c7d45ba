// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/submap.hpp"

#include <catch2/catch.hpp>

#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

Keyframe keyframe_at(const Plan& plan, const Pose2& T_map_base) {
  const SensorInfo sensor = short_laser();
  return {T_map_base, orient(see(plan, sensor, T_map_base), sensor, {}, 10.0, 0.03), {0, 0}};
}

}  // namespace

TEST_CASE("the nearest surface is the one that looking at every point finds") {
  const Keyframe a = keyframe_at(furnished_room(), {0, 0, 0.3}), b = keyframe_at(furnished_room(), {1.5, 1, -2});
  Submap map;
  map.build({&a, &b}, 0.06, 1.0);
  std::vector<OrientedPoint> all;
  for (const Keyframe* keyframe : {&a, &b})
    for (OrientedPoint point : keyframe->points_base)
      if (point.has_normal()) {
        point.p = keyframe->T_map_base * point.p;
        point.n = rotation(keyframe->T_map_base.heading) * point.n;
        all.push_back(point);
      }
  REQUIRE(map.size() == all.size());

  RandomStream random(41, RandomStreamId::kLaser);
  int found = 0, none = 0;
  for (int round = 0; round < 2000; ++round) {
    const Eigen::Vector2d p(random.uniform(-5, 5), random.uniform(-4, 4));
    const double angle_rad = random.uniform(-kPi, kPi), gate_m = random.uniform(0.05, 0.9);
    const Eigen::Vector2d n(std::cos(angle_rad), std::sin(angle_rad));
    const OrientedPoint* nearest = nullptr;
    for (const OrientedPoint& q : all)
      if (q.n.dot(n) >= 0.9 && (q.p - p).norm() < gate_m && (!nearest || (q.p - p).norm() < (nearest->p - p).norm())) nearest = &q;
    Surface surface;
    REQUIRE(map.nearest_surface(p, n, gate_m, 0.9, surface) == (nearest != nullptr));
    if (!nearest) {
      ++none;
      continue;
    }
    ++found;
    REQUIRE((surface.p - nearest->p).norm() < 0.121);  // the average of points around the nearest
    REQUIRE(surface.n.dot(nearest->n) > 0.95);
    REQUIRE(surface.count >= 1);
  }
  REQUIRE(found > 100);
  REQUIRE(none > 100);
}

TEST_CASE("a wall blocks the view of what lies behind it, a doorway does not") {
  Plan plan;
  plan.push_back({{-3, 2}, {-0.5, 2}});
  plan.push_back({{0.5, 2}, {3, 2}});  // a doorway of a metre in the middle
  const Keyframe a = keyframe_at(plan, {}), b = keyframe_at(plan, {-0.5, 0, 0.1}), c = keyframe_at(plan, {0.4, 0.2, 0.2});
  Submap map;
  map.build({&a, &b, &c}, 0.06, 1.0);
  REQUIRE(map.is_blocked({-1.5, 0}, {-1.5, 5}, 0.3));
  REQUIRE_FALSE(map.is_blocked({0, 0}, {0, 5}, 0.3));
  REQUIRE_FALSE(map.is_blocked({-1.5, 0}, {-1.5, 2.0}, 0.3));  // it ends on the wall: that is a hit
}

TEST_CASE("an empty submap finds and blocks nothing") {
  Submap map;
  Surface surface;
  REQUIRE_FALSE(map.nearest_surface({0, 0}, {1, 0}, 0.5, 0.9, surface));
  map.build({}, 0.06, 1.0);
  const Keyframe blind{{}, {}, {0, 0}};
  map.build({&blind}, 0.06, 1.0);
  REQUIRE(map.size() == 0);
  REQUIRE_FALSE(map.nearest_surface({0, 0}, {1, 0}, 0.5, 0.9, surface));
  REQUIRE_FALSE(map.is_blocked({0, 0}, {1, 0}, 0.3));
}
