// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/furniture.hpp"
#include "common/semantics/wall_map.hpp"

#include <catch2/catch.hpp>

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
