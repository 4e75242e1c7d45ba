// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/truth.hpp"

#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

/// A robot that drives a square of 10 m, one pose every half metre and second.
Path square_drive() {
  Path path;
  Pose2 pose(3, 4, 0.7);
  for (int i = 0; i <= 80; ++i) {
    path.push_back({static_cast<double>(i), pose});
    pose = pose * Pose2(0.5, 0, i % 20 == 19 ? kPi / 2 : 0);
  }
  return path;
}

Path moved(const Path& path, const Pose2& T) {
  Path out = path;
  for (StampedPose& p : out) p.pose = T * p.pose;
  return out;
}

}  // namespace

TEST_CASE("A path that differs from the truth by a rigid motion has no error", "[evaluation]") {
  std::mt19937_64 random(4);
  for (int i = 0; i < 20; ++i) {
    const Pose2 T_map_world = random_pose(random, 50);
    const auto pairs = pair_with_truth(moved(square_drive(), T_map_world), square_drive());
    REQUIRE(pairs.size() == 81);
    CHECK_THAT(align_first(pairs), IsNear(T_map_world.inverse(), 1e-9, 1e-9));
    CHECK_THAT(align_least_squares(pairs), IsNear(T_map_world.inverse(), 1e-9, 1e-9));
    CHECK(absolute_error(pairs, align_first(pairs)).position_m.max < 1e-9);
    CHECK(relative_error(pairs, 5).translation_m.max < 1e-9);
  }
}

TEST_CASE("Least squares is never worse in rms than the first pose", "[evaluation]") {
  std::mt19937_64 random(5);
  for (int i = 0; i < 50; ++i) {
    Path estimate = square_drive();
    for (StampedPose& p : estimate) p.pose = p.pose * random_pose(random, 0.3);
    const auto pairs = pair_with_truth(estimate, square_drive());
    const double rms_m = absolute_error(pairs, align_least_squares(pairs)).position_m.rms;
    CHECK(rms_m <= absolute_error(pairs, align_first(pairs)).position_m.rms + 1e-12);
    Pose2 nudged = align_least_squares(pairs);
    nudged.heading += 1e-3;
    CHECK(rms_m <= absolute_error(pairs, nudged).position_m.rms);
  }
}

TEST_CASE("A scale of 1 % on a straight line shows as 1 % of the distance", "[evaluation]") {
  std::vector<PosePair> pairs;
  for (int i = 0; i <= 200; ++i) pairs.push_back({i * 0.1, {0.1 * i, 0, 0}, {0.101 * i, 0, 0}});
  CHECK(absolute_error(pairs, align_first(pairs)).position_m.max == Approx(0.2));
  CHECK(relative_error(pairs, 5).translation_m.mean == Approx(0.05).epsilon(0.03));
  CHECK(relative_error(pairs, 10).rotation_deg.max == Approx(0).margin(1e-9));
  CHECK(relative_error(pairs, 50).translation_m.count == 0);
}

TEST_CASE("Estimates outside the truth or in its gaps are counted, not guessed", "[evaluation]") {
  std::size_t unpaired = 0;
  const Path truth = {{0, {0, 0, 0}}, {1, {1, 0, 0}}, {9, {9, 0, 0}}};
  const auto pairs =
      pair_with_truth({{-1, {}}, {0.5, {}}, {5, {}}, {9, {}}, {10, {}}}, truth, &unpaired);
  CHECK(pairs.size() == 2);
  CHECK(unpaired == 3);
  CHECK_THAT(pairs[0].T_world_base, IsNear({0.5, 0, 0}, 1e-12, 1e-12));
}

TEST_CASE("A robot that never moved is aligned by its heading", "[evaluation]") {
  const std::vector<PosePair> pairs(5, PosePair{0, {1, 2, 0.5}, {0, 0, 0}});
  CHECK_THAT(align_least_squares(pairs), IsNear({1, 2, 0.5}, 1e-12, 1e-12));
}

TEST_CASE("TUM lines become planar poses, and a wrong line is named", "[evaluation]") {
  const Path path = parse_tum("# comment\n1.5 1 2 0 0 0 0.7071067811865476 0.7071067811865476\n");
  REQUIRE(path.size() == 1);
  CHECK_THAT(path[0].pose, IsNear({1, 2, kPi / 2}, 1e-12, 1e-12));
  CHECK_THROWS_WITH(parse_tum("1 2 3\n"), Catch::Contains("line 1"));
  CHECK_THROWS_WITH(parse_tum("1 1 2 0 0 0 0 0\n"), Catch::Contains("quaternion"));
  CHECK_THROWS_WITH(parse_tum("\n"), Catch::Contains("no pose"));
}
