// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/robust.hpp"

#include <algorithm>

#include "common/formats/file_bytes.hpp"
#include "common/formats/graph_file.hpp"
#include "common/graph/consistency.hpp"
#include "tests/support/data.hpp"
#include "tests/support/false_loops.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// Adds false loops and requires that all of them are refused, that hardly a true one is (one in a thousand true loops lies beyond the
/// limit by chance) and that the answer is the clean one.
void require_refused(const PoseGraph& file, int false_loops, FalseLoops kind, std::uint64_t seed) {
  PoseGraph clean = file;
  SparseOptimizer(clean).initialize_chordal(clean);
  const double best = optimize_gauss_newton(clean, {100, 1e-10, 0.0}).chi2_after;
  PoseGraph graph = file;
  add_false_loops(graph, clean.poses, false_loops, kind, 10, seed);
  const RobustResult result = optimize_robustly(graph, {});
  CAPTURE(seed, false_loops, kind == FalseLoops::kSamePlace);
  const auto first_false = std::lower_bound(result.refused.begin(), result.refused.end(), file.edges.size());
  REQUIRE(result.refused.end() - first_false == false_loops);
  REQUIRE(first_false - result.refused.begin() <= 1);
  PoseGraph true_edges = file;
  true_edges.poses = graph.poses;
  if (first_false == result.refused.begin()) REQUIRE(graph_chi2(true_edges) == Approx(best).epsilon(1e-2));
  for (std::size_t k = 0; k < graph.poses.size(); ++k) REQUIRE_THAT(graph.poses[k], IsNear(clean.poses[k], 0.1, 0.1));
}

}  // namespace

TEST_CASE("rings of loops close within their covariance when the loops are true, and not when one is false") {
  PoseGraph graph = swept_field(10, 0.03, 501);
  const DrivenWay way(graph);
  double sum = 0;
  int count = 0, far_off = 0;
  for (const GraphEdge& a : graph.edges)
    for (const GraphEdge& b : graph.edges) {
      if (a.kind != EdgeKind::kLoop || b.kind != EdgeKind::kLoop || a.id >= b.id || b.to - a.to > 8) continue;
      sum += ring_chi2(way, a, b);
      ++count;
      GraphEdge wrong = b;
      wrong.T_from_to = b.T_from_to * Pose2(1.5, 0, 0);
      far_off += ring_chi2(way, a, wrong) > 11.34;
    }
  REQUIRE(count > 200);
  REQUIRE(sum / count == Approx(3).epsilon(0.3));  // chi-square with 3 degrees of freedom
  REQUIRE(far_off > 0.95 * count);
}

TEST_CASE("the covariance of the driven way is the same from either end and nothing on the spot") {
  const PoseGraph graph = swept_field(6, 0.05, 502);
  const DrivenWay way(graph);
  REQUIRE(way.covariance(7, 7).norm() < 1e-12);
  // Seen from the other end: carried there.
  const Pose2 T = way.motion(3, 20);
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topLeftCorner<2, 2>() = rotation(T.heading);
  A(0, 2) = T.y, A(1, 2) = -T.x;
  REQUIRE((A * way.covariance(20, 3) * A.transpose() - way.covariance(3, 20)).norm() < 1e-9);
}

TEST_CASE("the largest set of loops that all agree is found among decoys") {
  // 0-1-2-3 all know each other; 4 and 5 know many, but not each other's friends.
  std::vector<std::vector<std::size_t>> friends = {{1, 2, 3, 4}, {0, 2, 3, 5}, {0, 1, 3}, {0, 1, 2, 4, 5}, {0, 3}, {1, 3}};
  REQUIRE(large_clique(friends) == std::vector<std::size_t>{0, 1, 2, 3});
  REQUIRE(large_clique({{}, {}}).size() == 1);
  REQUIRE(large_clique({}).empty());
}

TEST_CASE("limits come down with values that are far smaller than they claim, and stay otherwise") {
  REQUIRE(fitted_limit(16, std::vector<double>(20, 2.4), 16) == 16);
  REQUIRE(fitted_limit(16, std::vector<double>(20, 0.02366), 16) == Approx(16 * 0.16));
  REQUIRE(fitted_limit(16, std::vector<double>(5, 0.01), 16) == 16);
  REQUIRE(fitted_limit(16, {}, 16) == 16);
}

TEST_CASE("false loops, up to twice as many as true ones, are refused") {
  for (const std::uint64_t seed : {511u, 512u, 513u})
    for (const FalseLoops kind : {FalseLoops::kSamePlace, FalseLoops::kAnywhere}) {
      require_refused(swept_field(12, 0.03, seed), 60, kind, seed);
      require_refused(swept_field(12, 0.03, seed), 264, kind, seed);
    }
}

TEST_CASE("information that is a hundred times too small does not let false loops in") {
  PoseGraph graph = swept_field(12, 0.03, 521);
  for (GraphEdge& e : graph.edges) e.information /= 100;
  require_refused(graph, 100, FalseLoops::kAnywhere, 521);
}

TEST_CASE("a clean graph loses no loop") {
  for (const std::uint64_t seed : {531u, 532u, 533u}) {
    PoseGraph graph = swept_field(12, 0.05, seed);
    REQUIRE(optimize_robustly(graph, {}).refused.empty());
  }
}

TEST_CASE("graduated non-convexity drops the false loops among true ones from a bad start") {
  std::vector<Pose2> truth;
  PoseGraph graph = swept_field(8, 0.03, 541, &truth);
  const std::size_t true_edges = graph.edges.size();
  add_false_loops(graph, truth, 15, FalseLoops::kAnywhere, 8, 541);
  const EdgeWeights weights = graduate(graph, 16.27, {50, 1e-8, 0.0});
  for (std::size_t k = 0; k < weights.size(); ++k) {
    INFO("edge " << k);
    REQUIRE(weights[k] == (k < true_edges ? 1.0 : 0.0));
  }
}

TEST_CASE("a chain with one loop, or none, is left to it") {
  PoseGraph one = square_loop(40, 0.02, 551), none = one;
  none.edges.pop_back();
  REQUIRE(optimize_robustly(one, {}).refused.empty());
  REQUIRE(optimize_robustly(none, {}).refused.empty());
}

TEST_CASE("public graphs with 1000 and with 80 % false loops give the clean answer") {
  const std::pair<const char*, int> cases[] = {{"g2o_manhattanOlson3500.g2o.xz", 1000}, {"g2o_intel.g2o.xz", 3580}};
  for (const auto& [name, count] : cases) {
    PoseGraph graph;
    try {
      graph = parse_graph(read_file_bytes(shared_file(std::string("data/graphs/") + name)).bytes).graph;
    } catch (const std::runtime_error&) {
      WARN("no data of " << name << ": skipped");
      continue;
    }
    for (const FalseLoops kind : {FalseLoops::kSamePlace, FalseLoops::kAnywhere}) require_refused(graph, count, kind, 561);
  }
}
