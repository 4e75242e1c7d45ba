// SPDX-License-Identifier: BSD-3-Clause
/// Furniture kept in step with walls that come and go, and the walls by number below it.
#include "common/semantics/furniture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>

#include "common/world/random.hpp"

using namespace modslam;

namespace {

constexpr std::uint64_t kSeed = 611;

Wall wall(double ax, double ay, double bx, double by) {
  Wall w;
  w.a = {ax, ay};
  w.b = {bx, by};
  return w;
}

const auto nowhere_free = [](const Eigen::Vector2d&) { return false; };

/// Rooms along x, each with a cupboard in a corner; some with a desk.
std::vector<Wall> rooms(int count) {
  std::vector<Wall> walls;
  for (int k = 0; k < count; ++k) {
    const double x = 5.0 * k;
    for (const Wall& w : {wall(x, 0, x + 4.8, 0), wall(x + 4.8, 0, x + 4.8, 4), wall(x + 4.8, 4, x, 4), wall(x, 4, x, 0)}) walls.push_back(w);
    walls.push_back(wall(x + 1, 0.6, x + 2.2, 0.6));
    walls.push_back(wall(x + 1, 0, x + 1, 0.6));
    if (k % 2) walls.push_back(wall(x + 2, 2, x + 3.2, 2));
  }
  return walls;
}

}  // namespace

TEST_CASE("furniture after walls came, went and changed places is what all of it at once would be") {
  RandomStream random(kSeed, RandomStreamId::kLaser);
  const std::vector<Wall> all = rooms(12);
  Slots<Wall> numbered;
  for (const Wall& w : all) numbered.take(w);
  FurnitureMap map;
  int found = 0;
  double free_from_m = 60;
  for (int round = 0; round < 60; ++round) {
    NumberNews news;
    std::vector<Wall> walls;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const bool there = random.uniform(0, 1) < 0.8, was_there = map.walls().has(k);
      if (there) walls.push_back(all[k]);
      if (there != was_there) (there ? news.come : news.gone).push_back(k);
    }
    const bool seen_more = round % 2 == 0;
    if (seen_more) free_from_m = random.uniform(0, 60);
    const auto is_free = [&](const Eigen::Vector2d& p) { return p.x() > free_from_m; };
    std::vector<bool> before, kept;
    for (std::size_t k = 0; k < all.size(); ++k) before.push_back(round > 0 && map.is_furniture(k));
    const Numbers touched = map.update(news, numbered, is_free, seen_more ? std::vector<PlanBox>{{{0, -1}, {60, 5}}} : std::vector<PlanBox>{});
    for (const std::size_t k : map.walls().numbers()) {
      kept.push_back(map.is_furniture(k));
      const auto is_told = [&](const Numbers& numbers) { return std::find(numbers.begin(), numbers.end(), k) != numbers.end(); };
      REQUIRE((map.is_furniture(k) == before[k] || is_told(touched) || is_told(news.come)));
    }
    REQUIRE(kept == find_furniture(walls, is_free));
    found += static_cast<int>(std::count(kept.begin(), kept.end(), true));
  }
  REQUIRE(found > 100);
}

TEST_CASE("the other face of a thick wall tells a face between a cupboard and a door from a thing that stands alone") {
  std::vector<Wall> walls = {wall(0, 0, 20, 0), wall(20, 0, 20, 9), wall(5, 6, 6.1, 6)};
  REQUIRE(find_furniture(walls, nowhere_free)[2]);
  walls.push_back(wall(12, 5.5, 4, 5.5));
  REQUIRE_FALSE(find_furniture(walls, nowhere_free)[2]);
}

TEST_CASE("of numbered walls those in a set are found near their places only, and what is gone can still be read") {
  Slots<Wall> numbered;
  const std::size_t first = numbered.take(wall(0, 0, 4, 0)), second = numbered.take(wall(40, 0, 44, 0));
  WallSet set;
  set.take({{}, {first, second}}, numbered);
  REQUIRE(set.size() == 2);
  numbered.give_back(first);
  const std::size_t third = numbered.take(wall(9, 9, 12, 9));
  REQUIRE(third != first);  // only from the next round on
  const auto is_in = [&](std::size_t k) { return set.has(k); };
  const NumberNews news = news_among({first, second, third}, is_in, [&](std::size_t k) { return k != first; });
  REQUIRE(news.gone == Numbers{first});
  REQUIRE(news.come == Numbers{third});
  set.take(news, numbered);
  REQUIRE(set[news.gone[0]].b == Eigen::Vector2d(4, 0));
  REQUIRE(set.numbers() == Numbers{second, third});
  REQUIRE(set.near({41, -1}, {42, 1}, 0.5) == Numbers{second});
  REQUIRE(set.near({0, 0}, {1, 0}, 0.5).empty());
  REQUIRE(set.has(third));
  numbered.next_round();
  REQUIRE(numbered.take(wall(1, 1, 2, 1)) == first);
}

TEST_CASE("a long counter is furniture where wall is seen in line behind both its ends, else a wall") {
  const Wall front = wall(3, 0.7, 9, 0.7), before = wall(0, 0, 3, 0), beyond = wall(9, 0, 12, 0), across = wall(20, 9, 0, 9);
  REQUIRE(find_furniture({before, front, beyond, across}, nowhere_free)[1]);
  REQUIRE_FALSE(find_furniture({before, front, across}, nowhere_free)[1]);
  REQUIRE_FALSE(find_furniture({before, front, beyond, across}, [](const Eigen::Vector2d&) { return true; })[1]);
  const Wall longer = wall(3, 0.7, 12, 0.7);
  REQUIRE_FALSE(find_furniture({before, longer, wall(12, 0, 15, 0), across}, nowhere_free)[1]);
}

TEST_CASE("the next stretch of a wall that bends away is not behind it, as the wall beside a cupboard is") {
  const double bend = 0.12, back = 3 * std::sin(bend);
  std::vector<Wall> walls{wall(-3 * std::cos(bend), -back, 0, 0), wall(0, 0, 3, 0), wall(3, 0, 3 + 3 * std::cos(bend), -back), wall(10, -10, 10, 10)};
  REQUIRE(find_furniture(walls, nowhere_free) == std::vector<bool>(4, false));
  walls[0] = wall(-3, -0.5, 0, -0.5);
  walls[2] = wall(3, -0.5, 6, -0.5);
  REQUIRE(find_furniture(walls, nowhere_free)[1]);
}

TEST_CASE("two faces that nothing joins to others are a piece of wall when they are as near as a wall is thin, else a thing") {
  const auto alone = [](double length_m, double thick_m) -> bool {
    const std::vector<Wall> walls{wall(0, 0, length_m, 0), wall(length_m, -thick_m, 0, -thick_m), wall(-10, 10, 10, 10)};
    return find_furniture(walls, nowhere_free)[0];
  };
  REQUIRE_FALSE(alone(2.5, 0.2));
  REQUIRE(alone(2.5, 0.6));
  REQUIRE(alone(0.9, 0.2));
}

TEST_CASE("what stands before a wall has a footprint from its front to the wall, once, whatever else was seen of it") {
  const std::vector<Wall> walls = {wall(0, 0, 6, 0), wall(6, 5, 0, 5), wall(2, 0.6, 3.6, 0.6), wall(2.2, 0.5, 3.2, 0.5)};
  Slots<Wall> numbered;
  NumberNews news;
  for (const Wall& w : walls) news.come.push_back(numbered.take(w));
  FurnitureMap map;
  map.update(news, numbered, nowhere_free, {});
  const auto found = map.footprints(nowhere_free);
  REQUIRE(found.size() == 1);
  REQUIRE((found[0][0] - Eigen::Vector2d(2, 0)).norm() < 1e-9);
  REQUIRE((found[0][2] - Eigen::Vector2d(3.6, 0.6)).norm() < 1e-9);
  // The floor is asked for again where it is new.
  const auto all_free = [](const Eigen::Vector2d&) { return true; };
  REQUIRE(map.footprints(all_free).size() == 1);
  map.update({}, numbered, nowhere_free, {{Eigen::Vector2d(-1, -1), Eigen::Vector2d(7, 6)}});
  REQUIRE(map.footprints(all_free).empty());
  map.update({{2, 3}, {}}, numbered, nowhere_free, {});
  REQUIRE(map.footprints(nowhere_free).empty());
}

TEST_CASE("the share of floor in a rectangle, however it lies") {
  const auto left_half = [](const Eigen::Vector2d& p) { return p.x() < 0; };
  for (const double turn_rad : {0.0, 0.5, 2.0}) {
    const Eigen::Rotation2D<double> turned(turn_rad);
    const auto free = [&](const Eigen::Vector2d& p) { return left_half(turned.inverse() * p); };
    std::array<Eigen::Vector2d, 4> ring = {Eigen::Vector2d(-1, 0), {3, 0}, {3, 2}, {-1, 2}};
    for (Eigen::Vector2d& corner : ring) corner = turned * corner;
    CHECK(floor_share(ring, free) == Approx(0.25).margin(0.03));
  }
  CHECK(floor_share({Eigen::Vector2d(1, 1), {1, 1}, {1, 1}, {1, 1}}, left_half) == 0);
}
