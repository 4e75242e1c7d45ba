// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

// Seen red: a stop rule that took the first sweep, which hands the loop's error to its neighbour whole, for the end.
TEST_CASE("TORO lowers chi2 of a noisy square to near the optimum, from odometry") {
  for (const std::uint64_t seed : {71u, 72u, 73u}) {
    PoseGraph descent = square_loop(60, 0.03, seed), exact = descent;
    OptimizeOptions options;
    options.max_iterations = 200;
    options.stop_relative = 1e-9;
    const OptimizeResult toro = optimize_toro(descent, options), newton = optimize_gauss_newton(exact, options);
    REQUIRE(toro.chi2_after < 0.5 * toro.chi2_before);
    REQUIRE(toro.chi2_after == Approx(graph_chi2(descent)));
    REQUIRE(toro.chi2_after < 3 * newton.chi2_after + 5);
    REQUIRE_THAT(descent.poses[0], IsNear({}, 0, 0));
  }
}

TEST_CASE("TORO never hands back a worse graph than it was given") {
  PoseGraph graph = square_loop(40, 0.05, 74);
  optimize_gauss_newton(graph, {});
  const double best = graph_chi2(graph);
  optimize_toro(graph, {});
  REQUIRE(graph_chi2(graph) <= best * (1 + 1e-12));
}

TEST_CASE("one loop edge with equal weights halves the gap between its two stories") {
  PoseGraph graph;
  graph.poses = {{}, {1, 0, 0}};
  graph.edges = {edge(0, 1, {1.0, 0, 0}), edge(0, 1, {1.2, 0, 0}, EdgeKind::kLoop)};
  OptimizeOptions options;
  options.max_iterations = 300;
  options.stop_relative = 1e-12;
  optimize_toro(graph, options);
  REQUIRE_THAT(graph.poses[1], IsNear({1.1, 0, 0}, 0.01, 0.01));
}
