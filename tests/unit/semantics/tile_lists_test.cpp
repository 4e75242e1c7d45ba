// SPDX-License-Identifier: BSD-3-Clause
/// Lists of tiles in one array.
#include "common/semantics/tile_lists.hpp"

#include <catch2/catch.hpp>

#include "common/world/random.hpp"

using namespace modslam;

namespace {

std::vector<std::vector<int>> told(const TileLists<int>& lists, int tiles) {
  std::vector<std::vector<int>> out;
  for (int tile = 0; tile < tiles; ++tile) out.emplace_back(lists.begin(tile), lists.end(tile));
  return out;
}

}  // namespace

TEST_CASE("whatever lists are replaced and however the raster grows, each tile has its own") {
  RandomStream random(33, RandomStreamId::kLaser);
  const auto draw = [&](int below) { return static_cast<int>(random.uniform(0, below - 1e-9)); };
  int columns = 3, rows = 2, number = 0;
  TileLists<int> lists(columns * rows);
  std::vector<std::vector<int>> expected(static_cast<std::size_t>(columns * rows));
  for (int round = 0; round < 300; ++round) {
    std::map<int, std::vector<int>> news;
    for (int k = draw(5); k > 0; --k) {
      std::vector<int> list(static_cast<std::size_t>(draw(4)));
      for (int& one : list) one = ++number;
      const int tile = draw(columns * rows);
      expected[static_cast<std::size_t>(tile)] = news[tile] = list;
    }
    lists.replace(news);
    REQUIRE(told(lists, columns * rows) == expected);
    if (round % 30 != 29) continue;
    const int left = draw(3), above = draw(3), wide = columns + left + draw(2), high = rows + above + draw(2);
    std::vector<std::vector<int>> grown(static_cast<std::size_t>(wide * high));
    for (int tile = 0; tile < columns * rows; ++tile)
      grown[static_cast<std::size_t>((tile / columns + above) * wide + tile % columns + left)] = expected[static_cast<std::size_t>(tile)];
    lists.grow(columns, wide, high, left, above);
    columns = wide, rows = high, expected = grown;
    REQUIRE(told(lists, columns * rows) == expected);
  }
}

TEST_CASE("no tiles at all are no trouble") {
  TileLists<int> lists;
  lists.replace({});
  REQUIRE(lists.all().empty());
}
