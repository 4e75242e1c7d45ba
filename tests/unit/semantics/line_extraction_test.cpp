// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/line_extraction.hpp"

#include <catch2/catch.hpp>

#include "tests/support/ray_world.hpp"

using namespace modslam;

namespace {

ClassifiedScan lines_of(test::RayWorld& world, const Pose2& pose) {
  const Scan scan = world.scan(pose);
  return extract_lines(points_base(scan, test::RayWorld::sensor()), scan.radstep, {});
}

}  // namespace

TEST_CASE("A noisy square room gives four lines with the right ends", "[semantics]") {
  test::RayWorld world;
  world.box(-3, -2, 3, 2);
  const Pose2 pose(0, 0, std::atan2(2, 3));  // the scan starts and ends in a corner
  const ClassifiedScan lines = lines_of(world, pose);
  REQUIRE(lines.segments.size() == 4);
  const std::vector<Eigen::Vector2d> corners = {{-3, -2}, {3, -2}, {3, 2}, {-3, 2}};
  for (const Segment& s : lines.segments) {
    for (const Eigen::Vector2d& end : {s.a, s.b}) {
      double nearest = 1e9;
      for (const Eigen::Vector2d& corner : corners)
        nearest = std::min(nearest, (pose * end - corner).norm());
      CHECK(nearest < 0.12);
    }
  }
}

TEST_CASE("Points on a small circle lie on no line", "[semantics]") {
  std::vector<ScanPoint> points;
  for (int i = 0; i < 120; ++i) {
    const double angle = i * kPi / 60;
    points.push_back({{4 + 0.4 * std::cos(angle), 0.4 * std::sin(angle)}, 4, 0, i});
  }
  CHECK(extract_lines(points, kPi / 180, {}).segments.empty());
}

TEST_CASE("A wide gap in a wall splits it into two segments", "[semantics]") {
  test::RayWorld world;
  world.wall(-3, 2, -0.6, 2);
  world.wall(0.6, 2, 3, 2);
  CHECK(lines_of(world, {}).segments.size() == 2);
}

TEST_CASE("No points and one point give no lines", "[semantics]") {
  CHECK(extract_lines({}, 0.01, {}).segments.empty());
  CHECK(extract_lines({{{1, 1}, 1.4, 0.8, 0}}, 0.01, {}).segments.empty());
}

TEST_CASE("The same points give the same segments", "[semantics]") {
  test::RayWorld world;
  world.box(-3, -2, 3, 2);
  world.box(1, 0.5, 2, 1.2);
  const Scan scan = world.scan({});
  const auto points = points_base(scan, test::RayWorld::sensor());
  const ClassifiedScan once = extract_lines(points, scan.radstep, {}),
                       again = extract_lines(points, scan.radstep, {});
  CHECK(once.segment_of == again.segment_of);
}
