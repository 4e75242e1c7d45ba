// SPDX-License-Identifier: BSD-3-Clause
/// Where walls end, against the truth.
#include "common/evaluation/wall_end_scores.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace modslam;

namespace {

/// A wall of 6 m along x with one of 3 m on its upper side, at 4 m.
std::vector<MapWall> tee() { return {{{0, 0}, {6, 0}, 0.2, {}}, {{4, 0}, {4, 3}, 0.2, {}}}; }

/// The lower wall's upper face, as far as the other wall: ends at 0.02 and 3.95, told with these standard deviations.
MapWall found_face(double along_m, double across_m = 0.02) {
  return {{3.95, 0.11}, {0.02, 0.11}, 0, {{across_m, along_m, true}, {across_m, along_m, true}}};
}

WallEndScores score(const std::vector<MapWall>& found) {
  SemanticMap map, truth;
  map.walls = found;
  truth.walls = tee();
  return score_wall_ends(map, truth);
}

}  // namespace

TEST_CASE("a wall's face ends where another wall stands before it, and goes on where that has its end") {
  std::vector<double> lengths_m;
  for (const WallFace& face : true_faces(tee())) lengths_m.push_back((face.b - face.a).norm());
  std::sort(lengths_m.begin(), lengths_m.end());
  // Above: 3.9 and 1.9 m beside the other wall, of which 2.9 m stand out on both sides; below: all of it.
  REQUIRE(lengths_m.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) CHECK(lengths_m[k] == Approx(std::vector<double>{1.9, 2.9, 2.9, 3.9, 6}[k]).margin(0.005));
}

TEST_CASE("two walls in line, end to end, have one face on each side") {
  REQUIRE(true_faces({{{0, 0}, {2, 0}, 0.1, {}}, {{2, 0}, {5, 0}, 0.1, {}}, {{5, 0}, {9, 0}, 0.1, {}}}).size() == 2);
  REQUIRE(true_faces({}).empty());
  REQUIRE(true_faces({{{1, 1}, {1, 1}, 0.1, {}}}).empty());
}

TEST_CASE("ends are measured along and across the true face, and held against what was told of them") {
  const WallEndScores wide = score({found_face(0.05)});
  CHECK(wide.told == 2);
  CHECK(wide.on_face == 2);
  CHECK(wide.along_m.max == Approx(0.05).margin(0.002));
  CHECK(wide.along_m.mean == Approx(0.035).margin(0.002));
  CHECK(wide.across_m.max == Approx(0.01).margin(0.002));
  CHECK(wide.along_within == 1);
  CHECK(wide.across_within == 1);
  CHECK(score({found_face(0.015)}).along_within == 0.5);
  CHECK(score({found_face(0.05, 0.002)}).across_within == 0);
}

TEST_CASE("what is no true wall, or was not seen to end, has no say") {
  MapWall cupboard = found_face(0.05);
  for (Eigen::Vector2d* p : {&cupboard.a, &cupboard.b}) p->y() += 0.5;
  CHECK(score({cupboard}).told == 2);
  CHECK(score({cupboard}).on_face == 0);
  MapWall cut_off = found_face(0.05);
  cut_off.ends[0].seen = false;
  CHECK(score({cut_off}).on_face == 1);
  CHECK(score({}).along_within == 0);
}
