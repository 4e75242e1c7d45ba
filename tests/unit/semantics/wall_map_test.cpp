// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/furniture.hpp"
#include "common/semantics/wall_map.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>
#include <tuple>

#include "common/world/random.hpp"

using namespace modslam;

namespace {

Segment segment(double ax, double ay, double bx, double by) {
  Segment s;
  s.a = {ax, ay};
  s.b = {bx, by};
  s.points = 40;
  s.sigma_m = 0.01;
  return s;
}

Wall wall(double ax, double ay, double bx, double by) {
  Wall w;
  w.a = {ax, ay};
  w.b = {bx, by};
  return w;
}

bool everywhere(const Eigen::Vector2d&) { return true; }

}  // namespace

TEST_CASE("two halves of a wall, each seen twice, are one wall") {
  const PlacedSegments left = {segment(0, 0, 2.1, 0.01)}, right = {segment(1.9, 0.02, 4, 0.01)};
  const auto bands = merge_segments({left, right, left, right}, {}, everywhere);
  REQUIRE(bands.size() == 1);
  REQUIRE(bands[0].walls.size() == 1);
  REQUIRE((bands[0].walls[0].a - Eigen::Vector2d(0, 0)).norm() < 0.08);
  REQUIRE((bands[0].walls[0].b - Eigen::Vector2d(4, 0.01)).norm() < 0.08);
}

TEST_CASE("two faces 0.15 m apart stay two walls, whichever side they are seen from") {
  for (const bool other_side : {false, true}) {
    const PlacedSegments face = {segment(0, 0, 4, 0)};
    const PlacedSegments behind = {other_side ? segment(4, 0.15, 0, 0.15) : segment(0, 0.15, 4, 0.15)};
    const auto bands = merge_segments({face, behind, face, behind}, {}, everywhere);
    REQUIRE(bands.size() == 2);
    for (const WallBand& band : bands) REQUIRE(band.walls.at(0).length_m() == Approx(4).margin(0.1));
    REQUIRE(std::abs(bands[0].walls[0].a.y() - bands[1].walls[0].a.y()) == Approx(0.15).margin(1e-6));
  }
}

TEST_CASE("a line that beams pass through is no wall, the solid stretch of it is") {
  const PlacedSegments scan = {segment(0, 0, 4, 0)};
  REQUIRE(merge_segments({scan, scan}, {}, [](const Eigen::Vector2d&) { return false; }).empty());
  const auto bands = merge_segments({scan, scan}, {}, [](const Eigen::Vector2d& p) { return p.x() < 1.5; });
  REQUIRE(bands.size() == 1);
  REQUIRE(bands[0].walls.at(0).b.x() == Approx(1.5).margin(0.06));
}

TEST_CASE("what a single scan saw is not a wall yet") {
  REQUIRE(merge_segments({{segment(0, 0, 4, 0)}}, {}, everywhere).empty());
  REQUIRE(merge_segments({}, {}, everywhere).empty());
}

TEST_CASE("a door leaves two walls of one band in order along it") {
  const PlacedSegments scan = {segment(3, 0, 4.5, 0), segment(0, 0, 2.1, 0)};
  const auto bands = merge_segments({scan, scan}, {}, everywhere);
  REQUIRE(bands.size() == 1);
  REQUIRE(bands[0].walls.size() == 2);
  REQUIRE(bands[0].walls[0].b.x() == Approx(2.1).margin(0.06));
  REQUIRE(bands[0].walls[1].a.x() == Approx(3.0).margin(0.06));
}

TEST_CASE("stretches that began far apart on one line are one band once the wall between them is seen") {
  // The longest segments found bands 6 m apart; the short one between belongs to both.
  const PlacedSegments scan = {segment(0, 0, 5, 0), segment(11, 0, 15, 0), segment(6, 0, 8.5, 0), segment(9.5, 0, 10.5, 0)};
  const auto bands = merge_segments({scan, scan}, {}, everywhere);
  REQUIRE(bands.size() == 1);
  REQUIRE(bands[0].walls.size() == 4);
  for (std::size_t k = 1; k < 4; ++k) REQUIRE(bands[0].walls[k].a.x() > bands[0].walls[k - 1].b.x());
}

TEST_CASE("walls whose evidence comes and goes are those of all at once, and the news tell what became of each number") {
  RandomStream random(31, RandomStreamId::kLaser);
  std::vector<Segment> all;  // along streets 6 m apart, over many blocks, with gaps, seen a little differently each time
  for (int street = 0; street < 5; ++street)
    for (int k = 0; k < 40; ++k) {
      const double along = random.uniform(0, 45), length = random.uniform(0.6, 6), across = 6 * street + random.uniform(-0.02, 0.02);
      all.push_back(street % 2 ? segment(along, across, along + length, across) : segment(across, along, across, along + length));
    }
  double solid_to = 60;
  int finished = 0;
  const auto is_solid = [&](const Eigen::Vector2d& p) { return p.x() < solid_to; };
  const auto finish = [&](Wall& w) { w.evidence = w.a.x() + 2 * w.b.y(), ++finished; };
  const auto order = [](const Wall& p, const Wall& q) { return std::tuple(p.a.x(), p.a.y(), p.b.x(), p.b.y()) < std::tuple(q.a.x(), q.a.y(), q.b.x(), q.b.y()); };
  WallMap map{WallMapOptions()};
  std::vector<bool> in(all.size(), false);
  std::set<std::size_t> there;
  std::size_t most = 0;
  for (int round = 0; round < 60; ++round) {
    for (std::size_t k = 0; k < all.size(); ++k)
      if (random.uniform(0, 1) < 0.04) {
        in[k] = !in[k];
        for (int twice = 0; twice < 2; ++twice) map.add(all[k], in[k] ? 1 : -1);
      }
    const double before = solid_to;
    if (round % 7 == 0) solid_to = random.uniform(5, 60);
    const WallMap::News news = map.update(is_solid, finish, {plan_box({std::min(before, solid_to), -1}, {std::max(before, solid_to), 60}, 0.3)});
    for (const std::size_t number : news.gone) REQUIRE(there.erase(number) == 1);
    for (const std::size_t number : news.come) REQUIRE(there.insert(number).second);
    for (const std::size_t number : news.altered) REQUIRE(there.count(number) == 1);

    WallMap anew{WallMapOptions()};
    for (std::size_t k = 0; k < all.size(); ++k)
      for (int twice = 0; in[k] && twice < 2; ++twice) anew.add(all[k], 1);
    const WallMap::News everything = anew.update(is_solid, finish, {});
    std::vector<Wall> kept, fresh;
    for (const std::size_t number : there) kept.push_back(map.walls()[number]);
    for (const std::size_t number : everything.come) fresh.push_back(anew.walls()[number]);
    std::sort(kept.begin(), kept.end(), order);
    std::sort(fresh.begin(), fresh.end(), order);
    REQUIRE(kept.size() == fresh.size());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      REQUIRE((kept[k].a == fresh[k].a && kept[k].b == fresh[k].b));
      REQUIRE(kept[k].evidence == fresh[k].evidence);
      REQUIRE(kept[k].at_a.across_m == fresh[k].at_a.across_m);
    }
    for (const WallBand& band : map.bands())
      for (std::size_t k = 1; k < band.walls.size(); ++k) REQUIRE((band.walls[k].a - band.walls[k - 1].a).dot(band.walls[k].direction()) > 0);
    for (const std::size_t number : there) {
      const WallMap::Neighbours& beside = map.beside(number);
      if (beside.after != WallMap::kNone) REQUIRE(map.beside(beside.after).before == number);
      if (beside.before != WallMap::kNone) REQUIRE(map.beside(beside.before).after == number);
    }
    most = std::max(most, there.size());
  }
  REQUIRE(most > 20);
}

TEST_CASE("merging gives the same bytes for the same segments") {
  const PlacedSegments scan = {segment(3, 0, 4.5, 0.02), segment(0, 0, 2.1, 0), segment(0, 1, 0, 5)};
  const auto once = merge_segments({scan, scan}, {}, everywhere), again = merge_segments({scan, scan}, {}, everywhere);
  REQUIRE(once.size() == again.size());
  for (std::size_t k = 0; k < once.size(); ++k)
    for (std::size_t j = 0; j < once[k].walls.size(); ++j) REQUIRE(once[k].walls[j].a == again[k].walls[j].a);
}

namespace {

const auto nowhere_free = [](const Eigen::Vector2d&) { return false; };

}  // namespace

TEST_CASE("the front and side of a wardrobe before a wall are furniture, the wall is not") {
  // Free side to the left of a -> b: the room is above; the wardrobe reaches from x = 2 to 3.2, 0.6 m deep.
  const std::vector<Wall> walls = {wall(0, 0, 2, 0), wall(3.2, 0, 6, 0), wall(2, 0.6, 3.2, 0.6), wall(2, 0, 2, 0.6)};
  REQUIRE(find_furniture(walls, nowhere_free) == std::vector<bool>{false, false, true, true});
  // Floor was seen behind the front: then it is a wall of its own.
  REQUIRE_FALSE(find_furniture(walls, [](const Eigen::Vector2d&) { return true; })[2]);
}

TEST_CASE("the end of a partition and the far wall of a narrow room are no furniture") {
  const std::vector<Wall> walls = {wall(0, 0, 12, 0), wall(12, 0.9, 0, 0.9), wall(0, 4, 5, 4)};
  REQUIRE(find_furniture(walls, nowhere_free) == std::vector<bool>{false, false, false});
}

TEST_CASE("the two edges of a desk in the middle of a hall are furniture; the first walls of a run are not") {
  std::vector<Wall> walls = {wall(0, 0, 12, 0), wall(12, 0, 12, 8), wall(5, 4, 6.5, 4), wall(6.5, 4, 6.5, 4.8)};
  REQUIRE(find_furniture(walls, nowhere_free) == std::vector<bool>{false, false, true, true});
  walls.erase(walls.begin(), walls.begin() + 2);
  REQUIRE(find_furniture(walls, nowhere_free) == std::vector<bool>{false, false});
  REQUIRE(find_furniture({}, nowhere_free).empty());
}

TEST_CASE("a hundred thousand segments on a hundred walls are merged to a hundred walls") {
  std::vector<PlacedSegments> scans(1000);
  for (int scan = 0; scan < 1000; ++scan)
    for (int k = 0; k < 100; ++k) scans[static_cast<std::size_t>(scan)].push_back(segment(0, k, 3 + 0.001 * (scan % 7), k));
  REQUIRE(merge_segments(scans, {}, everywhere).size() == 100);
}
