// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "common/graph/toro.hpp"
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
    const OptimizeResult toro = Toro().optimize(descent, options), newton = optimize_gauss_newton(exact, options);
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
  Toro().optimize(graph, {});
  REQUIRE(graph_chi2(graph) <= best * (1 + 1e-12));
}

TEST_CASE("one loop edge with equal weights halves the gap between its two stories") {
  PoseGraph graph;
  graph.poses = {{}, {1, 0, 0}};
  graph.edges = {edge(0, 1, {1.0, 0, 0}), edge(0, 1, {1.2, 0, 0}, EdgeKind::kLoop)};
  OptimizeOptions options;
  options.max_iterations = 300;
  options.stop_relative = 1e-12;
  Toro().optimize(graph, options);
  REQUIRE_THAT(graph.poses[1], IsNear({1.1, 0, 0}, 0.01, 0.01));
}

namespace {

/// The nodes and edges of `whole` one node at a time, as a robot meets them, with an update after each.
PoseGraph drive(const PoseGraph& whole, Toro& toro) {
  std::vector<GraphEdge> edges = whole.edges;
  std::stable_sort(edges.begin(), edges.end(), [](const GraphEdge& a, const GraphEdge& b) { return std::max(a.from, a.to) < std::max(b.from, b.to); });
  PoseGraph graph;
  graph.poses = {whole.poses[0]};
  for (auto edge = edges.begin(); edge != edges.end();) {
    const NodeId node = std::max(edge->from, edge->to);
    graph.poses.push_back(graph.poses.back() * edge->T_from_to);  // a node's sequence edge comes first
    for (; edge != edges.end() && std::max(edge->from, edge->to) == node; ++edge) graph.edges.push_back(*edge);
    toro.update(graph, {});
  }
  return graph;
}

}  // namespace

TEST_CASE("TORO edge by edge ends near where it ends with the whole graph") {
  for (const std::uint64_t seed : {75u, 76u, 77u}) {
    PoseGraph whole = swept_field(12, 0.03, seed);
    OptimizeOptions options;
    options.max_iterations = 200;
    options.stop_relative = 1e-9;
    Toro toro;
    const double driven = graph_chi2(drive(whole, toro)), batch = Toro().optimize(whole, options).chi2_after;
    CAPTURE(seed, driven, batch);
    REQUIRE(driven < 1.5 * batch);
  }
}

TEST_CASE("a new edge that agrees with the graph wakes no other edge") {
  Toro toro;
  PoseGraph graph = drive(swept_field(16, 0.03, 78), toro);
  const double chi2 = graph_chi2(graph);
  const std::int64_t pulls_before = toro.pulls();
  GraphEdge agreeing = graph.edges.back();
  agreeing.id = static_cast<EdgeId>(graph.edges.size());
  agreeing.T_from_to = between(graph.poses[static_cast<std::size_t>(agreeing.from)], graph.poses[static_cast<std::size_t>(agreeing.to)]);
  graph.edges.push_back(agreeing);
  toro.update(graph, {});
  REQUIRE(toro.pulls() == pulls_before + 1);
  REQUIRE(graph_chi2(graph) == Approx(chi2));
}

TEST_CASE("TORO goes on when edges were taken back and poses were moved by others") {
  Toro toro;
  PoseGraph graph = drive(swept_field(8, 0.03, 79), toro);
  graph.edges.erase(graph.edges.end() - 10, graph.edges.end() - 5);
  optimize_gauss_newton(graph, {});
  const double best = graph_chi2(graph);
  const std::int64_t pulls_before = toro.pulls();
  toro.update(graph, {});
  REQUIRE(toro.pulls() == pulls_before);  // nothing is new
  REQUIRE(graph_chi2(graph) == Approx(best));
}
