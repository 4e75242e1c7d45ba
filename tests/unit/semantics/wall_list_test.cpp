// SPDX-License-Identifier: BSD-3-Clause
/// The list of walls that others see, kept in step with numbered walls.
#include "common/semantics/wall_list.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "common/world/random.hpp"

using namespace modslam;

TEST_CASE("a list that is kept has the walls that belong to it, as they are by now, with their ids, and new ones at its end") {
  constexpr std::size_t kCount = 40;
  RandomStream random(23, RandomStreamId::kLaser);
  std::vector<double> evidence(kCount, 0);
  std::set<std::size_t> there;
  WallList kept;
  std::vector<Wall> list;
  const auto wall_of = [&](std::size_t number) {
    Wall wall;
    wall.a = {static_cast<double>(number), 0};
    wall.b = {static_cast<double>(number), 1};
    wall.evidence = evidence[number];
    return wall;
  };
  const auto number_of = [](const Wall& wall) { return static_cast<std::size_t>(wall.a.x()); };
  std::size_t went = 0;
  for (int round = 0; round < 50; ++round) {
    NumberNews news;
    Numbers altered;
    std::set<std::size_t> gone;
    for (std::size_t k = 0; k < kCount; ++k) {
      if (random.uniform(0, 1) < 0.2) {
        if (there.erase(k)) news.gone.push_back(k), gone.insert(k);
        else news.come.push_back(k), there.insert(k);
      }
      if (random.uniform(0, 1) < 0.3) evidence[k] += 1, altered.push_back(k);  // also of walls that are not listed
    }
    const std::vector<Wall> told = kept.update(list, news, altered, wall_of);
    REQUIRE(told.size() == gone.size());
    for (const Wall& wall : told) {
      REQUIRE(gone.count(number_of(wall)) == 1);
      REQUIRE(wall.id == static_cast<std::int64_t>(number_of(wall)) + 1);
    }
    went += told.size();
    REQUIRE(list.size() == there.size());
    for (std::size_t place = 0; place < list.size(); ++place) {
      const std::size_t number = number_of(list[place]);
      REQUIRE(there.count(number) == 1);
      REQUIRE(kept.has(number));
      REQUIRE(list[place].evidence == evidence[number]);
      const bool is_new = place + news.come.size() >= list.size();
      REQUIRE(list[place].id == (is_new ? 0 : static_cast<std::int64_t>(number) + 1));
      list[place].id = static_cast<std::int64_t>(number) + 1;
    }
  }
  REQUIRE(went > 100);
}
