// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/cell_index.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <set>

#include "common/world/random.hpp"

using namespace modslam;

namespace {
struct Numbered {
  Eigen::Vector2d p;
  int number;
};
}  // namespace

TEST_CASE("an index of cells visits every point within its reach, like a look at all of them") {
  RandomStream random(5, RandomStreamId::kLaser);
  std::vector<Numbered> all;
  for (int k = 0; k < 500; ++k) all.push_back({{random.uniform(-3, 4), random.uniform(-8, 2)}, k});
  CellIndex<Numbered> index(0.5);
  index.build(all);
  REQUIRE(index.points().size() == all.size());
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector2d p(random.uniform(-4, 5), random.uniform(-9, 3));
    std::set<int> near, visited;
    for (const Numbered& point : all)
      if ((point.p - p).norm() < 0.5) near.insert(point.number);
    index.for_points_around(p, 1, [&](std::size_t i) {
      if ((index.points()[i].p - p).norm() < 0.5) visited.insert(index.points()[i].number);
    });
    REQUIRE(visited == near);
  }
}

TEST_CASE("an empty index visits nothing, and points too far out are left out") {
  CellIndex<Numbered> index(0.1);
  int visited = 0;
  index.for_points_around({0, 0}, 3, [&](std::size_t) { ++visited; });
  REQUIRE(visited == 0);
  index.build({{{0, 0}, 1}, {{1e6, 0}, 2}});
  REQUIRE(index.points().size() == 1);
}

TEST_CASE("walls askew to the axes take no more cells than walls along them") {
  const auto cells_of_room = [](double turn_rad) {
    const Eigen::Rotation2D<double> turned(turn_rad);
    std::vector<Numbered> outline;
    for (double s = 0; s < 20; s += 0.05)
      for (const Eigen::Vector2d& p : {Eigen::Vector2d(s, 0), {s, 4}, {0, s / 5}, {20, s / 5}}) outline.push_back({turned * p, 0});
    CellIndex<Numbered> index(0.1);
    index.build(outline);
    CHECK(index.points().size() == outline.size());
    return index.cells();
  };
  const std::size_t along = cells_of_room(0);
  CHECK(along >= 200 * 40);
  for (const double turn_rad : {0.1, 0.4, 0.8}) CHECK(static_cast<double>(cells_of_room(turn_rad)) < 1.1 * static_cast<double>(along));
}
