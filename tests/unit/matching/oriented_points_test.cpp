// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/oriented_points.hpp"

#include <catch2/catch.hpp>

#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

TEST_CASE("normals of walls point at the sensor and stand square to the wall") {
  const SensorInfo sensor = short_laser();
  const auto points = orient(see(corridor(), sensor, {}), sensor, {}, 10.0, 0.03);
  std::size_t with_normal = 0;
  for (const OrientedPoint& point : points) {
    if (!point.has_normal()) continue;  // beyond the last beams that still hit the wall side by side
    ++with_normal;
    REQUIRE(point.n.norm() == Approx(1.0));
    REQUIRE(point.n.y() == Approx(point.p.y() > 0 ? -1.0 : 1.0).margin(1e-4));
  }
  REQUIRE(with_normal > 150);
  REQUIRE(points.size() - with_normal < 10);
}

TEST_CASE("a point on a wall is known across it as well as its beam meets it squarely") {
  const SensorInfo sensor = short_laser();
  const RangeNoise noise;
  for (const OrientedPoint& point : orient(see(corridor(), sensor, {}), sensor, noise, 10.0, 0.03)) {
    if (!point.has_normal()) continue;
    const double cosine = std::abs(point.p.y()) / point.p.norm(), sine2 = 1 - cosine * cosine;
    const double across_beam = noise.sigma_bearing_rad * point.p.norm();
    const double expected = noise.sigma_range_m * noise.sigma_range_m * cosine * cosine + across_beam * across_beam * sine2;
    REQUIRE(point.var_m2 == Approx(expected).epsilon(0.01));
  }
}

TEST_CASE("surfaces do not reach across a depth jump") {
  // A post half a metre before the wall: the points beside its edges keep the wall's own normal.
  Plan plan = corridor();
  plan.push_back({{-0.2, 0.75}, {0.2, 0.75}});
  const SensorInfo sensor = short_laser();
  for (const OrientedPoint& point : orient(see(plan, sensor, {}), sensor, {}, 10.0, 0.0))
    if (point.has_normal()) REQUIRE(std::abs(point.n.y()) > 0.999);
}

TEST_CASE("points nearer than the spacing and beams beyond the limit are left out") {
  const SensorInfo sensor = short_laser();
  const auto points = orient(see(furnished_room(), sensor, {}), sensor, {}, 3.0, 0.10);
  REQUIRE(points.size() > 15);
  for (std::size_t k = 0; k < points.size(); ++k) {
    REQUIRE(points[k].p.norm() <= 3.0 + 1e-6);
    if (k) REQUIRE((points[k].p - points[k - 1].p).norm() >= 0.10);
  }
}

TEST_CASE("one lonely return is a point without a surface") {
  Scan scan;
  scan.ranges_m = {0.0f, 0.0f, 2.0f, 0.0f};
  scan.radstep = 0.01;
  const auto points = orient(scan, SensorInfo(), {}, 10.0, 0.03);
  REQUIRE(points.size() == 1);
  REQUIRE_FALSE(points[0].has_normal());
  REQUIRE(orient(Scan(), SensorInfo(), {}, 10.0, 0.03).empty());
}
