// SPDX-License-Identifier: BSD-3-Clause
/// What nobody saw inside rooms, kept in step with rooms that come and go.
#include "common/semantics/hidden_space.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/world/random.hpp"
#include "tests/support/floor_raster.hpp"

using namespace modslam;

namespace {

Corners rectangle(double x0, double y0, double x1, double y1) { return Corners{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

/// A hall of 20 x 12 m with blocks in it that nobody looked behind.
KnownSpace hall() {
  KnownSpace space = test::unknown_floor(20, 12);
  test::fill(space, 0.5, 0.5, 19.5, 11.5, test::kFree);
  for (const double x : {3.0, 9.0, 15.0})
    for (const double y : {2.0, 7.0}) test::fill(space, x, y, x + 2.5, y + 2.5, test::kUnknown);
  return space;
}

}  // namespace

TEST_CASE("hidden is what lies inside a room, off its outline, and is no floor") {
  const KnownSpace space = hall();
  const Floor floor = make_floor(space, 4);
  HiddenSpace hidden;
  const Corners room = rectangle(2, 1, 7, 6);
  hidden.update({{}, {room}}, space, floor, {});
  const auto is_hidden = [&](double x, double y) { return hidden.contains(space.cell({x, y})); };
  REQUIRE(is_hidden(4, 3));
  REQUIRE_FALSE(is_hidden(2.5, 1.5));   // floor
  REQUIRE_FALSE(is_hidden(4, 8));       // in no room
  REQUIRE_FALSE(is_hidden(10, 3));
  const Corners smaller = rectangle(2, 1, 4.2, 6);
  hidden.update({{room}, {smaller}}, space, floor, {});
  REQUIRE(is_hidden(3.5, 3));
  REQUIRE_FALSE(is_hidden(4.15, 3));    // at the outline
  REQUIRE_FALSE(is_hidden(5, 3));
}

TEST_CASE("hidden space after rooms came and went is that of the rooms that are there") {
  const KnownSpace space = hall();
  const Floor floor = make_floor(space, 4);
  RandomStream random(71, RandomStreamId::kLaser);
  std::vector<Corners> there;
  HiddenSpace kept;
  int hidden = 0;
  for (int round = 0; round < 40; ++round) {
    RoomMap::News news;
    while (there.size() > 4 || (!there.empty() && random.uniform(0, 1) < 0.4)) {
      news.gone.push_back(there.front());
      there.erase(there.begin());
    }
    const double x = random.uniform(1, 12), y = random.uniform(1, 6);
    news.come.push_back(rectangle(x, y, x + random.uniform(2, 7), y + random.uniform(2, 5)));
    there.push_back(news.come.back());
    kept.update(news, space, floor, {});
    HiddenSpace anew;
    anew.update({{}, there}, space, floor, {});
    for (int row = 0; row < space.occupancy.rows; ++row)
      for (int column = 0; column < space.occupancy.cols; ++column) {
        REQUIRE(kept.contains({column, row}) == anew.contains({column, row}));
        hidden += kept.contains({column, row});
      }
  }
  REQUIRE(hidden > 1000);
}
