// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/relative_covariance.hpp"

#include <Eigen/Cholesky>

#include "common/loops/place_match.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

std::vector<const GraphEdge*> pointers(const PoseGraph& graph) {
  std::vector<const GraphEdge*> out;
  for (const GraphEdge& e : graph.edges) out.push_back(&e);
  return out;
}

/// Covariance of a pose from many noisy drives along a chain of edges (from `source` to the other end).
Eigen::Matrix3d sampled(const PoseGraph& graph, bool from_last) {
  RandomStream random(81, RandomStreamId::kOdometry);
  constexpr int kDraws = 40000;
  const std::size_t n = graph.poses.size();
  const Pose2 mean = from_last ? between(graph.poses[n - 1], graph.poses[0]) : between(graph.poses[0], graph.poses[n - 1]);
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    Pose2 T;
    for (const GraphEdge& e : graph.edges) {
      const Eigen::Matrix3d L = edge_covariance_from(e).llt().matrixL();
      T = T * Pose2(e.T_from_to.vector() + L * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    }
    if (from_last) T = T.inverse();
    Eigen::Vector3d d = T.vector() - mean.vector();
    d[2] = wrap_angle(d[2]);
    cov += d * d.transpose() / kDraws;
  }
  return cov;
}

PoseGraph bent_chain() {
  PoseGraph graph;
  graph.poses.push_back({});
  const Pose2 steps[] = {{1, 0, 0.5}, {1, 0.2, 0.8}, {1.5, 0, -0.3}};
  for (NodeId k = 0; k < 3; ++k) {
    graph.edges.push_back(edge(k, k + 1, steps[k]));
    graph.edges.back().information = Eigen::Vector3d(900, 2500, 1600).asDiagonal();
    graph.poses.push_back(graph.poses.back() * steps[k]);
  }
  return graph;
}

}  // namespace

TEST_CASE("covariance along a chain is what many noisy drives show, forward") {
  const PoseGraph graph = bent_chain();
  const Eigen::Matrix3d cov = RelativeCovariance(graph.poses, pointers(graph), 0)[3], expected = sampled(graph, false);
  REQUIRE((cov - expected).norm() < 0.05 * expected.norm());
}

TEST_CASE("covariance along a chain is what many noisy drives show, backward") {
  const PoseGraph graph = bent_chain();
  const Eigen::Matrix3d cov = RelativeCovariance(graph.poses, pointers(graph), 3)[0], expected = sampled(graph, true);
  INFO("composed\n" << cov << "\nsampled\n" << expected);
  REQUIRE((cov - expected).norm() < 0.05 * expected.norm());
}

TEST_CASE("a node is known perfectly relative to itself and a loop edge makes a far one near") {
  PoseGraph graph = square_loop(40, 0.0, 0);
  const std::vector<const GraphEdge*> all = pointers(graph);
  std::vector<const GraphEdge*> chain(all.begin(), all.end() - 1);
  REQUIRE(RelativeCovariance(graph.poses, all, 0)[0].norm() == 0);
  const double without = RelativeCovariance(graph.poses, chain, 0)[39].norm(), with = RelativeCovariance(graph.poses, all, 0)[39].norm();
  REQUIRE(with < 0.1 * without);
}

TEST_CASE("a node that no edge reaches has a huge covariance, one behind a blind edge a large one") {
  PoseGraph graph;
  graph.poses = {{}, {1, 0, 0}, {5, 5, 0}};
  graph.edges = {edge(0, 1, {1, 0, 0})};
  graph.edges[0].information.setZero();
  const RelativeCovariance cov(graph.poses, pointers(graph), 0);
  REQUIRE(cov[1](0, 0) == Approx(100.0));
  REQUIRE(cov[2](0, 0) >= 1e6);
}

TEST_CASE("asked for some nodes only, the search gives the same for them as the search for all") {
  PoseGraph graph = square_loop(40, 0.01, 3);
  const RelativeCovariance all(graph.poses, pointers(graph), 5), some(graph.poses, pointers(graph), 5, {9, 31});
  REQUIRE(all[9] == some[9]);
  REQUIRE(all[31] == some[31]);
}

TEST_CASE("along a chain the marginal is what the chain says; a second way makes it smaller, never larger") {
  const PoseGraph chain = bent_chain();
  for (const NodeId source : {0, 3}) {
    const RelativeCovariance along(chain.poses, pointers(chain), source);
    const std::vector<Eigen::Matrix3d> exact = marginal_covariances(chain.poses, pointers(chain), source);
    for (const NodeId target : {1, 2}) REQUIRE((exact[static_cast<std::size_t>(target)] - along[target]).norm() < 0.03 * along[target].norm());
  }
  PoseGraph field = swept_field(6, 0.05, 82);
  optimize_gauss_newton(field, {});
  const RelativeCovariance bound(field.poses, pointers(field), 35);
  const std::vector<Eigen::Matrix3d> exact = marginal_covariances(field.poses, pointers(field), 35);
  REQUIRE(exact[35].norm() == 0);
  for (NodeId target = 0; target < 35; ++target) {
    const double sigma = position_sigma(exact[static_cast<std::size_t>(target)]);
    CAPTURE(target, sigma, position_sigma(bound[target]));
    REQUIRE(sigma < position_sigma(bound[target]));
    REQUIRE(sigma > 0.2 * position_sigma(bound[target]));
  }
}
