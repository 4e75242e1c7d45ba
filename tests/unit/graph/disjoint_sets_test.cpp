// SPDX-License-Identifier: BSD-3-Clause
/// Numbers in sets, against labels that are painted over at each join.
#include "common/graph/disjoint_sets.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/world/random.hpp"

using namespace modslam;

TEST_CASE("numbers are in one set when a chain of joins leads from one to the other, and the lowest stands for it") {
  constexpr std::size_t kCount = 60;
  RandomStream random(17, RandomStreamId::kLaser);
  const auto any = [&] { return static_cast<std::size_t>(random.uniform(0, kCount - 0.01)); };
  for (int round = 0; round < 20; ++round) {
    DisjointSets sets(kCount);
    std::vector<std::size_t> lowest(kCount);
    for (std::size_t k = 0; k < kCount; ++k) lowest[k] = k;
    for (int joins = 0; joins < 3 * round; ++joins) {
      const std::size_t p = any(), q = any(), low = std::min(lowest[p], lowest[q]), high = std::max(lowest[p], lowest[q]);
      sets.join_lowest(p, q);
      std::replace(lowest.begin(), lowest.end(), high, low);
    }
    for (std::size_t k = 0; k < kCount; ++k) REQUIRE(sets.root(k) == lowest[k]);
  }
}

TEST_CASE("what goes takes the root of what stays") {
  DisjointSets sets(4);
  sets.join(0, 3);
  sets.join(3, 2);
  REQUIRE(sets.root(0) == 2);
  REQUIRE(sets.root(3) == 2);
  REQUIRE(sets.root(1) == 1);
  sets.join(2, 0);  // they are one already
  REQUIRE(sets.root(3) == 2);
}
