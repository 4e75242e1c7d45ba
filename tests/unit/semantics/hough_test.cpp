// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/hough.hpp"

#include <catch2/catch.hpp>

#include "tests/support/synthetic_scan.hpp"

using namespace modslam;

namespace {

LineExtraction lines_of(const Scan& scan, const SensorInfo& sensor) {
  return extract_lines(points_base(scan, sensor), sensor.T_base_laser.translation(), scan.radstep, {});
}

std::vector<ScanPoint> circle(double radius_m, const Eigen::Vector2d& centre, int count) {
  std::vector<ScanPoint> points;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * kPi * k / count;
    const Eigen::Vector2d p = centre + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    points.push_back({p, p.norm(), std::atan2(p.y(), p.x()), k});
  }
  return points;
}

}  // namespace

TEST_CASE("a noisy square seen from inside is four lines that end at its corners") {
  test::Plan plan;
  test::add_box(plan, -2, -2, 2, 2);
  const SensorInfo sensor = test::short_laser();
  RandomStream random(701, RandomStreamId::kLaser);
  const LineExtraction lines = lines_of(test::see(plan, sensor, {0.3, -0.2, 0.4}, &random), sensor);
  REQUIRE(lines.segments.size() == 4);
  const Pose2 T_map_base(0.3, -0.2, 0.4);
  for (const Segment& s : lines.segments) {
    for (const Eigen::Vector2d& end : {s.a, s.b}) {
      const Eigen::Vector2d p = T_map_base * end;
      REQUIRE(std::abs(std::abs(p.x()) - 2) < 0.12);
      REQUIRE(std::abs(std::abs(p.y()) - 2) < 0.12);
    }
    REQUIRE(s.sigma_m < 0.02);
    const Eigen::Vector2d d = s.b - s.a, to_eye = -s.a;
    REQUIRE(d.x() * to_eye.y() - d.y() * to_eye.x() > 0);  // the viewer is to the left
  }
  const auto on_lines = std::count(lines.on_segment.begin(), lines.on_segment.end(), true);
  REQUIRE(on_lines > 340);
}

TEST_CASE("points on a circle are no walls, small as a leg or wide as a tank") {
  for (const double radius_m : {0.15, 0.3, 0.6, 1.0}) {
    CAPTURE(radius_m);
    const LineExtraction lines = extract_lines(circle(radius_m, {3, 1}, 200), {0, 0}, 2 * kPi / 361, {});
    REQUIRE(lines.segments.empty());
    REQUIRE(std::count(lines.on_segment.begin(), lines.on_segment.end(), true) == 0);
  }
}

TEST_CASE("a straight wall stays one piece under the noise of a poor laser") {
  RandomStream random(702, RandomStreamId::kLaser);
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<ScanPoint> points;
    for (int k = 0; k < 40; ++k) {
      const Eigen::Vector2d p(-1 + 0.05 * k, 2 + 0.02 * random.normal());
      points.push_back({p, p.norm(), std::atan2(p.y(), p.x()), k});
    }
    const LineExtraction lines = extract_lines(points, {0, 0}, 0.02, {});
    CAPTURE(trial);
    REQUIRE(lines.segments.size() == 1);
    REQUIRE(lines.segments[0].length_m() > 1.7);
  }
}

TEST_CASE("a gap as wide as a door cuts a wall in two") {
  const test::Plan plan = {{{-3, 2}, {-0.45, 2}}, {{0.45, 2}, {3, 2}}};
  const SensorInfo sensor = test::short_laser();
  const LineExtraction lines = lines_of(test::see(plan, sensor, {}), sensor);
  REQUIRE(lines.segments.size() == 2);
  for (const Segment& s : lines.segments) REQUIRE(std::min(std::abs(s.a.x()), std::abs(s.b.x())) == Approx(0.45).margin(0.06));
}

TEST_CASE("nothing, one point and a handful of points hold no line") {
  for (const int count : {0, 1, 5}) {
    const LineExtraction lines = extract_lines(circle(1, {0, 0}, count), {0, 0}, 0.02, {});
    REQUIRE(lines.segments.empty());
    REQUIRE(lines.on_segment.size() == static_cast<std::size_t>(count));
  }
}
