// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/quad_tree.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "common/world/random.hpp"

using namespace modslam;

TEST_CASE("the quad tree finds exactly what looking at every point finds") {
  RandomStream random(101, RandomStreamId::kLaser);
  QuadTree tree;
  std::vector<Eigen::Vector2d> points;
  int found = 0;
  for (int k = 0; k < 1500; ++k) {
    // Clusters, a far outlier now and then that makes the root grow, and points on top of each other.
    const double size_m = k % 50 == 0 ? 500 : k % 3 == 0 ? 2 : 30;
    points.emplace_back(k % 7 == 0 && k ? points.back() : Eigen::Vector2d(random.uniform(-size_m, size_m), random.uniform(-size_m, size_m)));
    tree.insert(points.back(), k);
    if (k % 10) continue;
    const Eigen::Vector2d p(random.uniform(-40, 40), random.uniform(-40, 40));
    const double radius_m = random.uniform(0, 25);
    std::set<std::int64_t> expected, got;
    for (std::size_t i = 0; i < points.size(); ++i)
      if ((points[i] - p).norm() <= radius_m) expected.insert(static_cast<std::int64_t>(i));
    for (const auto& entry : tree.near(p, radius_m)) {
      got.insert(entry.id);
      REQUIRE(entry.p == points[static_cast<std::size_t>(entry.id)]);
    }
    REQUIRE(got == expected);
    found += static_cast<int>(got.size());
  }
  REQUIRE(tree.size() == 1500);
  REQUIRE(found > 1000);
}

TEST_CASE("an empty tree finds nothing, a cleared one forgets") {
  QuadTree tree;
  REQUIRE(tree.near({0, 0}, 100).empty());
  tree.insert({1, 1}, 7);
  REQUIRE(tree.near({0, 0}, 2).size() == 1);
  REQUIRE(tree.near({0, 0}, 1).empty());
  tree.clear();
  REQUIRE(tree.size() == 0);
  REQUIRE(tree.near({0, 0}, 100).empty());
}

TEST_CASE("a thousand points in one place do not split for ever") {
  QuadTree tree;
  for (int k = 0; k < 1000; ++k) tree.insert({3, -4}, k);
  REQUIRE(tree.near({3, -4}, 0).size() == 1000);
}
