// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/certificate.hpp"

#include "common/graph/sparse_optimizer.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

const OptimizeOptions kToTheEnd{300, 1e-13, 0.0};

/// A ring of `nodes` steps that turn by 360 deg in all, closed by its last edge. Poses may wind around `windings` times instead of once.
PoseGraph ring(int nodes, int windings) {
  PoseGraph graph;
  graph.poses.emplace_back();
  const double turn = 2 * kPi / nodes;
  for (NodeId k = 0; k < nodes; ++k) graph.edges.push_back(edge(k, (k + 1) % nodes, {1, 0, turn}, k + 1 == nodes ? EdgeKind::kLoop : EdgeKind::kSequence));
  for (int k = 1; k < nodes; ++k) graph.poses.push_back(graph.poses.back() * Pose2(1, 0, windings * turn));
  return graph;
}

}  // namespace

TEST_CASE("the optimum of noisy rings and fields is proven, with equal and unequal information") {
  for (const std::uint64_t seed : {461u, 462u, 463u})
    for (PoseGraph graph : {swept_field(8, 0.05, seed), square_loop(80, 0.03, seed)})
      for (const bool unequal : {false, true}) {
        if (unequal)
          for (GraphEdge& e : graph.edges) e.information << 300, 60, 5, 60, 150, -5, 5, -5, 400;
        SparseOptimizer(graph).initialize_chordal(graph);
        optimize_gauss_newton(graph, kToTheEnd);
        const Certificate certificate = certify(graph);
        REQUIRE(certificate.is_optimal);
        REQUIRE(certificate.chi2 == Approx(graph_chi2(graph)));
        REQUIRE(certificate.lower_bound == Approx(certificate.chi2).epsilon(2e-6).margin(1e-6));
        REQUIRE(certificate.min_eigenvalue > -1e-5);
      }
}

TEST_CASE("a ring that is wound up once too often is a local minimum, and nothing is proven of it") {
  PoseGraph right = ring(40, 1), wrong = ring(40, 2);
  optimize_gauss_newton(wrong, kToTheEnd);
  // A minimum it is: no small push of a pose helps.
  const double chi2 = graph_chi2(wrong);
  REQUIRE(chi2 > 100);
  for (std::size_t k = 1; k < wrong.poses.size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      for (const double h : {1e-4, -1e-4}) {
        PoseGraph pushed = wrong;
        pushed.poses[k] = Pose2(pushed.poses[k].vector() + h * Eigen::Vector3d::Unit(axis));
        REQUIRE(graph_chi2(pushed) > chi2);
      }
  const Certificate certificate = certify(wrong);
  REQUIRE_FALSE(certificate.is_optimal);
  REQUIRE(certificate.min_eigenvalue < -1e-3);
  REQUIRE(certificate.lower_bound < 1e-6);  // the true minimum is 0, and a bound above it would be a lie
  REQUIRE(certify(right).is_optimal);
}

TEST_CASE("the lower bound lies below chi2 of every arrangement, wherever it is asked for") {
  RandomStream random(471, RandomStreamId::kOdometry);
  for (int draw = 0; draw < 40; ++draw) {
    PoseGraph graph = swept_field(5, 0.1, 472);
    for (GraphEdge& e : graph.edges) e.information << 30, 9, 5, 9, 12, -3, 5, -3, 40;
    SparseOptimizer(graph).initialize_chordal(graph);
    optimize_gauss_newton(graph, kToTheEnd);
    const double best = graph_chi2(graph);
    const double size = 0.05 * draw;
    for (std::size_t k = 1; k < graph.poses.size(); ++k)
      graph.poses[k] = Pose2(graph.poses[k].vector() + size * Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    const Certificate certificate = certify(graph);
    REQUIRE(certificate.lower_bound <= best * (1 + 1e-9));
    if (draw > 0) REQUIRE_FALSE(certificate.is_optimal);
  }
}

// A bound from the cost of the poses instead of the multipliers once called an answer of TORO optimal.
TEST_CASE("nothing is proven of right headings with wrong positions") {
  PoseGraph graph = swept_field(8, 0.03, 475);
  optimize_gauss_newton(graph, kToTheEnd);
  const double best = graph_chi2(graph);
  for (const double share : {1e-4, 1e-3, 0.01, 0.1}) {
    PoseGraph stretched = graph;
    for (Pose2& pose : stretched.poses) pose.x *= 1 + share, pose.y *= 1 - share;
    const Certificate certificate = certify(stretched);
    REQUIRE(certificate.lower_bound <= best * (1 + 1e-9));
    if (certificate.is_optimal) REQUIRE(certificate.chi2 < best * (1 + 2e-6));
  }
}

TEST_CASE("poses that are turned and moved as a whole keep their proof") {
  PoseGraph graph = swept_field(6, 0.05, 481);
  optimize_gauss_newton(graph, kToTheEnd);
  for (Pose2& pose : graph.poses) pose = Pose2(50, -30, 2.5) * pose;
  REQUIRE(certify(graph).is_optimal);
}

TEST_CASE("graphs without edges have nothing to be proven") {
  REQUIRE(certify(PoseGraph()).is_optimal);
  PoseGraph one;
  one.poses.emplace_back();
  REQUIRE(certify(one).is_optimal);
}
