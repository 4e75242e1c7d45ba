// SPDX-License-Identifier: BSD-3-Clause
/// Pieces of floor joined by what speaks for and against.
#include <catch2/catch.hpp>

#include <random>

#include "common/semantics/region_clusters.hpp"

using namespace modslam;

namespace {

bool together(const std::vector<int>& clusters, int p, int q) { return clusters[static_cast<std::size_t>(p)] == clusters[static_cast<std::size_t>(q)]; }

}  // namespace

TEST_CASE("pieces without bonds stay alone, and none at all is no trouble") {
  REQUIRE(cluster_pieces(0, {}).empty());
  REQUIRE(cluster_pieces(3, {}) == std::vector<int>{0, 1, 2});
}

TEST_CASE("a doubtful cut joins two pieces, not when a surer one lies between the same two") {
  REQUIRE(together(cluster_pieces(2, {{0, 1, 1.0}}), 0, 1));
  REQUIRE_FALSE(together(cluster_pieces(2, {{0, 1, 1.0}, {1, 0, -3.0}}), 0, 1));
  REQUIRE(together(cluster_pieces(2, {{0, 1, 1.0}, {1, 0, -3.0}, {0, 1, 2.5}}), 0, 1));
}

TEST_CASE("a sure cut also holds against a way round through a third piece, which goes where it hangs on most") {
  const std::vector<int> clusters = cluster_pieces(3, {{0, 1, -4.0}, {0, 2, 2.0}, {2, 1, 1.0}});
  REQUIRE(together(clusters, 0, 2));
  REQUIRE_FALSE(together(clusters, 0, 1));
}

TEST_CASE("between clusters nothing is left that speaks for joining them, whatever the bonds") {
  std::mt19937 bits(7);
  const auto draw = [&](int below) { return static_cast<int>(bits() % static_cast<unsigned>(below)); };
  for (int round = 0; round < 200; ++round) {
    const int count = 2 + draw(30);
    std::vector<PieceBond> bonds;
    for (int k = draw(3 * count); k > 0; --k) bonds.push_back({draw(count), draw(count), 0.01 * (draw(1000) - 500)});
    const std::vector<int> clusters = cluster_pieces(count, bonds);
    std::vector<double> between(static_cast<std::size_t>(count * count), 0);
    for (const PieceBond& bond : bonds) {
      const int p = clusters[static_cast<std::size_t>(bond.p)], q = clusters[static_cast<std::size_t>(bond.q)];
      if (p != q) between[static_cast<std::size_t>(std::min(p, q) * count + std::max(p, q))] += bond.weight;
    }
    for (const double weight : between) REQUIRE(weight < 1e-9);
  }
}
