// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/trajectory_error.hpp"

#include "tests/support/matchers.hpp"

using namespace modslam;

TEST_CASE("truth is interpolated at the path's stamps and never across a gap") {
  const std::vector<PathPose> truth = {
      {300, {3, 0, 0.3}}, {100, {1, 0, 0.1}}, {200, {2, 0, 0.2}}, {9000, {9, 0, 0}}};
  const auto pairs =
      pair_path_with_truth({{50, {}}, {150, {}}, {300, {}}, {4000, {}}, {9999, {}}}, truth, 1000);
  REQUIRE(pairs.size() == 2);
  REQUIRE_THAT(pairs[0].T_world_base, IsNear({1.5, 0, 0.15}, 1e-12, 1e-12));
  REQUIRE_THAT(pairs[1].T_world_base, IsNear({3, 0, 0.3}, 1e-12, 1e-12));
}

TEST_CASE("both alignments undo any rigid motion of an exact path") {
  std::mt19937_64 random(11);
  for (int round = 0; round < 20; ++round) {
    const Pose2 T_world_map = random_pose(random, 20);
    std::vector<TruthPair> pairs;
    for (int i = 0; i < 30; ++i) {
      const Pose2 T_map_base = random_pose(random, 5);
      pairs.push_back({i, T_map_base, T_world_map * T_map_base});
    }
    REQUIRE_THAT(*lay_by_first_pose(pairs), IsNear(T_world_map, 1e-9, 1e-9));
    REQUIRE_THAT(*lay_by_least_squares(pairs), IsNear(T_world_map, 1e-9, 1e-9));
    REQUIRE(figures(path_error(pairs, T_world_map).position_m).max < 1e-9);
  }
}

TEST_CASE("least squares is never worse than the first pose, in rms") {
  std::mt19937_64 random(12);
  std::normal_distribution<double> noise(0, 0.1);
  for (int round = 0; round < 20; ++round) {
    std::vector<TruthPair> pairs;
    for (int i = 0; i < 40; ++i) {
      const Pose2 p = random_pose(random, 5);
      pairs.push_back(
          {i, {p.x + noise(random), p.y + noise(random), p.heading + noise(random)}, p});
    }
    const double first = figures(path_error(pairs, *lay_by_first_pose(pairs)).position_m).rms;
    const double best = figures(path_error(pairs, *lay_by_least_squares(pairs)).position_m).rms;
    REQUIRE(best <= first);
  }
}

TEST_CASE("a path that never moved is laid on its first pose, and an empty one has no alignment") {
  const std::vector<TruthPair> still(5, TruthPair{0, {1, 2, 0.3}, {4, 5, 1.3}});
  REQUIRE_THAT(*lay_by_least_squares(still), IsNear(*lay_by_first_pose(still), 1e-12, 1e-12));
  REQUIRE_FALSE(lay_by_first_pose({}).has_value());
  REQUIRE_FALSE(lay_by_least_squares({}).has_value());
  REQUIRE(figures({}).max == 0);
  REQUIRE(figures({3, 4}).rms == Approx(std::sqrt(12.5)));
}
