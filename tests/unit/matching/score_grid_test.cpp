// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/score_grid.hpp"

#include "common/world/random.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

std::vector<Eigen::Vector2d> random_points(RandomStream& random, int count, double size_m) {
  std::vector<Eigen::Vector2d> points;
  for (int k = 0; k < count; ++k) points.emplace_back(random.uniform(-size_m, size_m), random.uniform(-size_m, size_m));
  return points;
}

/// Every pose of the window, one after the other.
double best_score_by_trying(const ScoreGrid& grid, const std::vector<Eigen::Vector2d>& points, const Pose2& guess,
                            double half_m, double half_rad, double step_rad) {
  double best = 0;
  const int cells = static_cast<int>(std::ceil(half_m / 0.05)), angles = static_cast<int>(std::ceil(half_rad / step_rad));
  for (int a = -angles; a <= angles; ++a)
    for (int i = -cells; i <= cells; ++i)
      for (int j = -cells; j <= cells; ++j)
        best = std::max(best, grid.score(points, {guess.x + i * 0.05, guess.y + j * 0.05, guess.heading + a * step_rad}));
  return best;
}

}  // namespace

TEST_CASE("points that lie on the walls score 1, points far from them 0") {
  ScoreGrid grid;
  grid.build({{0, 0}, {1, 0}}, 0.06, 10.0);
  REQUIRE(grid.score({{0, 0}, {1, 0}}, {}) == Approx(1.0));
  REQUIRE(grid.score({{0, 0.8}, {1, 0.8}}, {}) == 0.0);
  REQUIRE(grid.score({{0, 0}, {500, 500}}, {}) == Approx(0.5));
}

TEST_CASE("best-first search finds as good a pose as trying every one") {
  RandomStream random(31, RandomStreamId::kLaser);
  int cases = 0;
  for (int round = 0; round < 40; ++round, ++cases) {
    ScoreGrid grid;
    grid.build(random_points(random, 60, 2.0), 0.06, 10.0);
    auto points = random_points(random, 30, 2.0);
    points.emplace_back(1.99, 0);  // the farthest of most points decides the step of the heading; see the clamp to 2 m
    const Pose2 guess(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-3, 3));
    SearchWindow window;
    window.half_m = round % 2 ? 0.4 : 1.4;  // the larger one uses all three levels
    window.half_rad = 0.1;
    const SearchResult found = grid.search(points, guess, window);
    std::vector<double> reach;
    for (const auto& p : points) reach.push_back(p.norm());
    std::sort(reach.begin(), reach.end());
    const double step_rad = 0.05 / std::clamp(reach[reach.size() * 8 / 10], 2.0, 15.0);
    const double best = best_score_by_trying(grid, points, guess, window.half_m, window.half_rad, step_rad);
    INFO("round " << round);
    // Cells are found by rounding once turned, then shifted; the slow way rounds each pose anew.
    REQUIRE(found.score == Approx(best).margin(0.02));
    REQUIRE(grid.score(points, found.T_map_base) == Approx(found.score).margin(0.02));
  }
  REQUIRE(cases == 40);
}

TEST_CASE("a shifted and turned copy of the walls is found where it lies") {
  RandomStream random(32, RandomStreamId::kLaser);
  for (int round = 0; round < 20; ++round) {
    const auto walls = random_points(random, 120, 4.0);
    ScoreGrid grid;
    grid.build(walls, 0.06, 10.0);
    const Pose2 truth(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(-0.2, 0.2));
    std::vector<Eigen::Vector2d> points;
    for (const auto& wall : walls) points.push_back(truth.inverse() * wall);
    SearchWindow window;
    window.half_m = 0.8;
    window.half_rad = 0.3;
    const SearchResult found = grid.search(points, {}, window, 0.5);
    REQUIRE_THAT(found.T_map_base, IsNear(truth, 0.06, 0.02));
    REQUIRE_FALSE(found.at_border);
    REQUIRE(found.second_score < 0.7 * found.score);
  }
}

TEST_CASE("two equal places are both seen: the second score comes near the first") {
  // A fence of posts every metre looks the same from every metre.
  std::vector<Eigen::Vector2d> posts, seen;
  for (int k = -10; k <= 10; ++k) posts.emplace_back(k, 1.0);
  for (int k = -3; k <= 3; ++k) seen.emplace_back(k, 1.0);
  ScoreGrid grid;
  grid.build(posts, 0.06, 10.0);
  SearchWindow window;
  window.half_m = 1.5;
  const SearchResult found = grid.search(seen, {}, window, 0.5);
  REQUIRE(found.second_score > 0.95 * found.score);
}

TEST_CASE("the preference for the guess decides between equal places") {
  std::vector<Eigen::Vector2d> posts;
  for (int k = -10; k <= 10; ++k) posts.emplace_back(k, 1.0);
  ScoreGrid grid;
  grid.build(posts, 0.06, 10.0);
  SearchWindow window;
  window.half_m = 1.5;
  window.prior_sigma_m = 0.2;
  window.prior_sigma_rad = 0.1;
  window.prior_weight = 0.002;
  REQUIRE_THAT(grid.search({{0, 1}, {1, 1}, {2, 1}}, {0.1, 0, 0}, window).T_map_base, IsNear({0, 0, 0}, 0.051, 0.03));
}

TEST_CASE("a maximum outside the window is announced at its border") {
  ScoreGrid grid;
  grid.build({{0, 0}, {0.5, 0.3}, {1, -0.2}}, 0.06, 10.0);
  SearchWindow window;
  window.half_m = 0.10;
  window.half_rad = 0.01;
  REQUIRE(grid.search({{0.15, 0}, {0.65, 0.3}, {1.15, -0.2}}, {}, window).at_border);
}

TEST_CASE("without walls or without points the guess comes back with score 0") {
  ScoreGrid grid;
  const Pose2 guess(1, 2, 0.3);
  REQUIRE(grid.empty());
  REQUIRE_THAT(grid.search({{1, 1}}, guess, {}).T_map_base, IsNear(guess, 0, 0));
  grid.build({{0, 0}}, 0.06, 10.0);
  REQUIRE(grid.search({}, guess, {}).score == 0.0);
  grid.build({}, 0.06, 10.0);
  REQUIRE(grid.empty());
}
