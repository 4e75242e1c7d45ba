// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/obstacles.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "tests/support/small_worlds.hpp"

namespace modslam {
namespace {

using Eigen::Vector2d;

/// Ray against segment, the slow and plain way.
double cast_at_segment(const Vector2d& origin, double bearing_rad, const Vector2d& a,
                       const Vector2d& b) {
  const Vector2d direction(std::cos(bearing_rad), std::sin(bearing_rad)), along = b - a,
                                                                          to_a = a - origin;
  const auto cross = [](const Vector2d& p, const Vector2d& q) {
    return p.x() * q.y() - p.y() * q.x();
  };
  const double area = cross(direction, along);
  if (area == 0) return std::numeric_limits<double>::infinity();
  const double range_m = cross(to_a, along) / area, share = cross(to_a, direction) / area;
  return range_m >= 0 && share >= 0 && share <= 1 ? range_m
                                                  : std::numeric_limits<double>::infinity();
}

TEST_CASE("a ray ends at the wall's face, not at its middle line") {
  const Obstacles obstacles(square_room());
  CHECK(obstacles.cast({0, 0}, 0, 20) == Approx(2.0).margin(1e-4));
  CHECK(obstacles.cast({0, 0}, kPi, 20) == Approx(2.0).margin(1e-4));
  CHECK(obstacles.cast({-1, 0.5}, kPi / 2, 20) == Approx(1.5).margin(1e-4));
  CHECK(obstacles.cast({0, 0}, -kPi / 4, 20) == Approx(2 * std::sqrt(2.0)).margin(1e-4));
}

TEST_CASE("a ray ends at an object, and at its largest range where nothing stands") {
  const Obstacles obstacles(square_room());
  CHECK(obstacles.cast({0, 0}, kPi / 4, 20) == Approx(std::sqrt(2.0)).margin(1e-4));
  CHECK(obstacles.cast({0, 0}, 0, 1.5) == 1.5);
  CHECK(Obstacles(World{}).cast({0, 0}, 1.0, 7) == 7);
}

TEST_CASE("a closed door stops rays, an open one does not") {
  World world;
  world.doors = {{"door", {2, -1}, {2, 1}, 2.0, true}};
  CHECK(Obstacles(world).cast({0, 0}, 0, 10) == 10);
  world.doors[0].open = false;
  CHECK(Obstacles(world).cast({0, 0}, 0, 10) == Approx(2.0).margin(0.05));
}

TEST_CASE("rays agree with brute force on random segments") {
  const std::uint64_t seed = 20240611;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-15, 15), angle(-kPi, kPi);
  World world;  // triangles: their edges are single segments
  for (int k = 0; k < 40; ++k) {
    const Vector2d a(place(random), place(random)), b(place(random), place(random));
    world.objects.push_back({"t", "", {a, a + 0.2 * (b - a), a + Vector2d(0.3, 0.7)}});
  }
  const Obstacles obstacles(world);
  int cases = 0, hits = 0;
  for (; cases < 2000; ++cases) {
    const Vector2d origin(place(random), place(random));
    const double bearing_rad = angle(random);
    double expected_m = 20;
    for (const WorldObject& object : world.objects)
      for (std::size_t k = 0; k < 3; ++k)
        expected_m = std::min(expected_m, cast_at_segment(origin, bearing_rad, object.polygon[k],
                                                          object.polygon[(k + 1) % 3]));
    INFO("seed " << seed << " case " << cases);
    // A ray along an edge's end may slip past in single precision: leave the last 0.1 mrad out.
    double aside_m = 20;
    for (const double off : {-1e-4, 1e-4}) {
      double beside_m = 20;
      for (const WorldObject& object : world.objects)
        for (std::size_t k = 0; k < 3; ++k)
          beside_m =
              std::min(beside_m, cast_at_segment(origin, bearing_rad + off, object.polygon[k],
                                                 object.polygon[(k + 1) % 3]));
      aside_m = std::min(aside_m, -std::abs(beside_m - expected_m));
    }
    if (aside_m < -0.05) continue;
    REQUIRE(obstacles.cast(origin, bearing_rad, 20) == Approx(expected_m).margin(1e-3));
    hits += expected_m < 20;
  }
  CHECK(hits > 500);
}

TEST_CASE("a circle touches a wall when its radius reaches the face") {
  const Obstacles obstacles(square_room());
  CHECK_FALSE(obstacles.touches_circle({0, 0}, 0.27));
  CHECK_FALSE(obstacles.touches_circle({-1.72, 0}, 0.27));
  CHECK(obstacles.touches_circle({-1.74, 0}, 0.27));
}

TEST_CASE("people walk to and fro, but only those who are enabled unless everybody walks") {
  World world;
  world.persons = {{"p", {{2, 0}, {5, 0}}, 0.25, 1.0, false}};
  CHECK(Obstacles(world).cast({0, 0}, 0, 20) == 20);
  Obstacles obstacles(world, true);
  obstacles.set_time(2);
  CHECK(obstacles.cast({0, 0}, 0, 20) == Approx(3.75));
  CHECK(obstacles.touches_circle({4.5, 0}, 0.27));
  obstacles.set_time(5);  // on the way back
  CHECK(obstacles.cast({0, 0}, 0, 20) == Approx(2.75));
  CHECK(obstacles.cast({3, 0}, 0, 20) == 0);  // from inside
}

}  // namespace
}  // namespace modslam
