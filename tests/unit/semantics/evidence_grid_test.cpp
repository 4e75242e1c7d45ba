// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/evidence_grid.hpp"

#include <catch2/catch.hpp>

#include "common/world/random.hpp"

using namespace modslam;

TEST_CASE("points on lines speak for a wall, others against it, many no louder than the limit") {
  EvidenceGrid grid;
  REQUIRE(grid.log_odds({1, 1}) == 0);
  grid.add({1.01, 1.01}, true, 1);
  REQUIRE(grid.log_odds({1.01, 1.01}) == Approx(0.4));
  grid.add({1.01, 1.01}, false, 1);
  grid.add({1.01, 1.01}, false, 1);
  REQUIRE(grid.log_odds({1.01, 1.01}) == Approx(-0.4));
  for (int k = 0; k < 1000; ++k) grid.add({1.01, 1.01}, true, 1);
  REQUIRE(grid.log_odds({1.01, 1.01}) == 6.0);
  REQUIRE(grid.log_odds({2, 1}) == 0);
  REQUIRE(grid.log_odds({-1.01, -1.01}) == 0);
}

TEST_CASE("taking a scan out leaves the evidence as if it had never been there") {
  RandomStream random(703, RandomStreamId::kLaser);
  struct Point {
    Eigen::Vector2d p;
    bool on_line;
  };
  std::vector<Point> stays, goes;
  for (int k = 0; k < 2000; ++k)
    (k % 3 ? stays : goes).push_back({{random.uniform(-3, 3), random.uniform(-3, 3)}, random.uniform(0, 1) < 0.5});
  EvidenceGrid with, without;
  for (const Point& point : goes) with.add(point.p, point.on_line, 1);
  for (const Point& point : stays) {
    with.add(point.p, point.on_line, 1);
    without.add(point.p, point.on_line, 1);
  }
  for (const Point& point : goes) with.add(point.p, point.on_line, -1);
  for (const Point& point : goes) REQUIRE(with.log_odds(point.p) == without.log_odds(point.p));
  for (const Point& point : stays) with.add(point.p, point.on_line, -1);
  for (const Point& point : stays) REQUIRE(with.log_odds(point.p) == 0);
}
