// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/random.hpp"
#include "common/graph/toro.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

TEST_CASE("a chain without loops is already at its optimum") {
  PoseGraph graph;
  graph.poses = {{}, {1, 0, 0}, {1, 1, kPi / 2}};
  graph.edges = {edge(0, 1, {1, 0, 0}), edge(1, 2, {0, 1, kPi / 2})};
  const OptimizeResult result = optimize_gauss_newton(graph, {});
  REQUIRE(result.iterations == 1);
  REQUIRE(result.chi2_after == Approx(0.0).margin(1e-12));
  REQUIRE_THAT(graph.poses[2], IsNear({1, 1, kPi / 2}, 1e-9, 1e-9));
}

TEST_CASE("two equal measurements that disagree meet in the middle") {
  PoseGraph graph;
  graph.poses = {{}, {1, 0, 0}};
  graph.edges = {edge(0, 1, {1.0, 0, 0}), edge(0, 1, {1.2, 0, 0}, EdgeKind::kLoop)};
  optimize_gauss_newton(graph, {});
  REQUIRE_THAT(graph.poses[1], IsNear({1.1, 0, 0}, 1e-6, 1e-6));
  REQUIRE(graph_chi2(graph) == Approx(100 * 2 * 0.1 * 0.1));
}

TEST_CASE("a driven square that does not close is spread over its sides, and node 0 stands still") {
  const PoseGraph truth = square_loop(40, 0.0, 0);
  PoseGraph graph = square_loop(40, 0.02, 61);
  const double error_before_m = distance(graph.poses[39], truth.poses[39]);
  const OptimizeResult result = optimize_gauss_newton(graph, {});
  REQUIRE(result.chi2_after < 0.2 * result.chi2_before);
  REQUIRE_THAT(graph.poses[0], IsNear({}, 0, 0));
  REQUIRE(distance(graph.poses[39], truth.poses[39]) < 0.3 * error_before_m);
}

TEST_CASE("at the optimum no small push of any pose lowers chi2: the Jacobians are right") {
  for (const std::uint64_t seed : {62u, 63u, 64u}) {
    PoseGraph graph = square_loop(20, 0.05, seed);
    // Full, coupled information: a wrong block of a Jacobian would show.
    for (GraphEdge& e : graph.edges) e.information << 120, 30, -10, 30, 80, 15, -10, 15, 400;
    OptimizeOptions options;
    options.max_iterations = 60;
    options.stop_relative = 1e-14;
    optimize_gauss_newton(graph, options);
    const double best = graph_chi2(graph);
    for (std::size_t k = 1; k < graph.poses.size(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        for (const double h : {1e-3, -1e-3}) {
          PoseGraph pushed = graph;
          pushed.poses[k] = Pose2(pushed.poses[k].vector() + h * Eigen::Vector3d::Unit(axis));
          REQUIRE(graph_chi2(pushed) > best);
        }
  }
}

TEST_CASE("Gauss-Newton converges quadratically: a handful of iterations to machine accuracy") {
  PoseGraph graph = square_loop(60, 0.01, 65);
  OptimizeOptions options;
  options.stop_relative = 1e-12;
  REQUIRE(optimize_gauss_newton(graph, options).iterations <= 6);
}

TEST_CASE("the whole graph may be turned and moved: chi2 does not care") {
  PoseGraph graph = square_loop(12, 0.05, 66);
  const double before = graph_chi2(graph);
  for (Pose2& pose : graph.poses) pose = Pose2(5, -3, 2.5) * pose;
  REQUIRE(graph_chi2(graph) == Approx(before));
}

TEST_CASE("dynamic covariance scaling keeps one wrong loop from bending a graph") {
  PoseGraph truth = square_loop(40, 0.0, 0), plain = square_loop(40, 0.003, 67);
  plain.edges.push_back(edge(0, 20, {0.5, 0.5, 0.3}, EdgeKind::kLoop));  // opposite corners called neighbours
  PoseGraph robust = plain;
  OptimizeOptions options;
  optimize_gauss_newton(plain, options);
  options.dcs_phi = 1.0;
  options.max_iterations = 50;
  optimize_gauss_newton(robust, options);
  REQUIRE(distance(plain.poses[20], truth.poses[20]) > 1.0);
  REQUIRE(distance(robust.poses[20], truth.poses[20]) < 0.1);
}

TEST_CASE("edges that see one direction only leave the others to their neighbours") {
  PoseGraph graph;
  graph.poses = {{}, {1, 0, 0}, {2, 0, 0}};
  graph.edges = {edge(0, 1, {1, 0, 0}), edge(1, 2, {1, 0, 0}), edge(0, 2, {5, 0.2, 0}, EdgeKind::kLoop)};
  graph.edges[2].information = Eigen::Vector3d(0, 100, 0).asDiagonal();  // says nothing of x
  optimize_gauss_newton(graph, {});
  REQUIRE(graph.poses[2].x == Approx(2.0).margin(0.02));
  REQUIRE(graph.poses[2].y > 0.05);
}

TEST_CASE("a node that no edge holds stays where it is") {
  PoseGraph graph;
  graph.poses = {{}, {1, 0, 0}, {7, 7, 1}};
  graph.edges = {edge(0, 1, {1.5, 0, 0})};
  optimize_gauss_newton(graph, {});
  REQUIRE_THAT(graph.poses[1], IsNear({1.5, 0, 0}, 1e-6, 1e-6));
  REQUIRE_THAT(graph.poses[2], IsNear({7, 7, 1}, 1e-9, 1e-9));
}

TEST_CASE("empty graphs and single nodes are left alone") {
  PoseGraph graph;
  REQUIRE(optimize_gauss_newton(graph, {}).iterations == 0);
  graph.poses.emplace_back(1, 2, 3);
  REQUIRE(optimize_gauss_newton(graph, {}).iterations == 0);
  REQUIRE(Toro().optimize(graph, {}).iterations == 0);
  REQUIRE_THAT(graph.poses[0], IsNear({1, 2, 3}, 0, 0));
}

TEST_CASE("poses from the spanning tree satisfy the edges of a chain, forward and backward") {
  PoseGraph graph;
  graph.poses.resize(3);
  graph.edges = {edge(1, 0, Pose2(1, 0.5, 0.3).inverse()), edge(1, 2, {2, 0, -0.2})};
  initialize_from_tree(graph);
  REQUIRE(graph_chi2(graph) == Approx(0.0).margin(1e-12));
}
