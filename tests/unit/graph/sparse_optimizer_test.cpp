// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/sparse_optimizer.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "common/formats/file_bytes.hpp"
#include "common/formats/graph_file.hpp"
#include "tests/support/data.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

const OptimizeOptions kToTheEnd{200, 1e-12, 0.0};

/// Dense matrix over random links, positive definite.
struct RandomSystem {
  std::vector<BlockPattern::Link> links;
  Eigen::MatrixXd A;

  RandomSystem(int n, int extra, std::uint64_t seed) {
    RandomStream random(seed, RandomStreamId::kOdometry);
    for (int k = 1; k < n; ++k) links.emplace_back(k - 1, k);
    for (int k = 0; k < extra; ++k) links.emplace_back(static_cast<int>(random.uniform(0, n)), static_cast<int>(random.uniform(0, n)));
    A = Eigen::MatrixXd::Identity(3 * n, 3 * n);
    for (auto& [a, b] : links) {
      if (a == b) b = (a + 1) % n;
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, 3 * n);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) J(r, 3 * a + c) = random.normal(), J(r, 3 * b + c) = random.normal();
      A += J.transpose() * J;
    }
  }
};

}  // namespace

TEST_CASE("the block factorisation solves random systems as a dense one does") {
  for (const std::uint64_t seed : {411u, 412u, 413u}) {
    const int n = 40;
    const RandomSystem system(n, 30, seed);
    const BlockPattern pattern(n, system.links);
    BlockCholesky<double, 3> factor(pattern);
    for (int v = 0; v < n; ++v) factor.diagonal(v) = system.A.block<3, 3>(3 * v, 3 * v);
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) {
        if (pattern.place(a) <= pattern.place(b) || system.A.block<3, 3>(3 * a, 3 * b).isZero(0)) continue;
        factor.add_below(pattern.entry(pattern.place(a), pattern.place(b)), system.A.block<3, 3>(3 * a, 3 * b));
      }
    REQUIRE(factor.factorize(false));
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * n, -1, 2);
    REQUIRE((system.A * factor.solve(b) - b).norm() < 1e-9);
  }
}

TEST_CASE("a matrix that is not positive is refused, or its unknown held, as asked") {
  const BlockPattern pattern(2, {{0, 1}});
  BlockCholesky<double, 3> factor(pattern);
  const auto fill = [&] {
    factor.clear();
    factor.diagonal(0) = Eigen::Vector3d(1, 1, 1).asDiagonal();
    factor.diagonal(1) = Eigen::Vector3d(1, 0, 4).asDiagonal();
  };
  fill();
  REQUIRE_FALSE(factor.factorize(false));
  fill();
  REQUIRE(factor.factorize(true));
  Eigen::VectorXd b(6);
  b << 1, 2, 3, 4, 5, 8;
  Eigen::VectorXd x(6);
  x << 1, 2, 3, 4, 0, 2;
  REQUIRE((factor.solve(b) - x).norm() < 1e-12);
}

TEST_CASE("the elimination order keeps the factor of a ring with spokes sparse") {
  std::vector<BlockPattern::Link> links;
  for (int k = 1; k < 300; ++k) links.emplace_back(0, k);  // taken first, the hub would fill everything
  for (int k = 1; k < 299; ++k) links.emplace_back(k, k + 1);
  REQUIRE(BlockPattern(300, links).blocks() < 3 * 300);
}

TEST_CASE("from exact measurements the chordal start is the answer, whatever the poses were") {
  std::vector<Pose2> truth;
  PoseGraph graph = swept_field(6, 1e-9, 421, &truth);
  for (Pose2& pose : graph.poses) pose = {3, 4, 2};
  graph.poses[0] = truth[0];
  SparseOptimizer(graph).initialize_chordal(graph);
  for (std::size_t k = 0; k < truth.size(); ++k) REQUIRE_THAT(graph.poses[k], IsNear(truth[k], 1e-6, 1e-6));
}

TEST_CASE("chordal, tree and odometry starts end at the same minimum of noisy rings and fields") {
  for (const std::uint64_t seed : {431u, 432u, 433u, 434u})
    for (PoseGraph graph : {swept_field(12, 0.05, seed), square_loop(200, 0.03, seed)}) {
      PoseGraph chordal = graph, tree = graph;
      SparseOptimizer optimizer(graph);
      optimizer.initialize_chordal(chordal);
      initialize_from_tree(tree);
      const double start = graph_chi2(chordal);
      const double best = optimizer.optimize(chordal, kToTheEnd).chi2_after;
      REQUIRE(start < 1.5 * best + 5);
      REQUIRE(optimizer.optimize(tree, kToTheEnd).chi2_after == Approx(best).epsilon(1e-7));
      REQUIRE(optimizer.optimize(graph, kToTheEnd).chi2_after == Approx(best).epsilon(1e-7));
    }
}

TEST_CASE("an edge of weight 0 is as good as not there") {
  PoseGraph graph = swept_field(5, 0.02, 441), without = graph;
  graph.edges.push_back(edge(0, 20, {5, 5, 1}, EdgeKind::kLoop));
  EdgeWeights weights(graph.edges.size(), 1.0);
  weights.back() = 0;
  SparseOptimizer(graph).optimize(graph, kToTheEnd, weights);
  optimize_gauss_newton(without, kToTheEnd);
  for (std::size_t k = 0; k < graph.poses.size(); ++k) REQUIRE_THAT(graph.poses[k], IsNear(without.poses[k], 1e-7, 1e-7));
}

TEST_CASE("a long arm that turns far converges where plain steps overshoot") {
  PoseGraph graph;  // 100 m straight ahead, whose first heading is wrong by 2 rad against one strong far edge
  graph.poses.resize(101);
  for (NodeId k = 0; k < 100; ++k) {
    graph.edges.push_back(edge(k, k + 1, {1, 0, 0}));
    graph.edges.back().information = Eigen::Vector3d(1e4, 1e4, k ? 1e6 : 1).asDiagonal();
  }
  graph.edges.push_back(edge(0, 100, Pose2(0, 0, 2) * Pose2(100, 0, 0), EdgeKind::kLoop));
  initialize_from_odometry(graph);
  const OptimizeResult result = optimize_gauss_newton(graph, kToTheEnd);
  REQUIRE(result.iterations < 20);
  REQUIRE(std::abs(graph.poses[50].heading - 2) < 0.05);
}

TEST_CASE("the marginal covariance is the inverse of the whole information, seen by the edge") {
  PoseGraph graph = swept_field(4, 0.05, 451);
  optimize_gauss_newton(graph, kToTheEnd);
  SparseOptimizer optimizer(graph);
  optimizer.prepare_marginals(graph);
  // Information by finite differences of the errors, inverted densely.
  const auto n = static_cast<Eigen::Index>(3 * (graph.poses.size() - 1));
  const auto jacobian = [&](const GraphEdge& e) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, n);
    for (const NodeId id : {e.from, e.to})
      for (int axis = 0; id > 0 && axis < 3; ++axis) {
        const auto error = [&](double h) {
          std::vector<Pose2> poses = graph.poses;
          auto& pose = poses[static_cast<std::size_t>(id)];
          pose = Pose2(pose.vector() + h * Eigen::Vector3d::Unit(axis));
          return edge_error(e, poses[static_cast<std::size_t>(e.from)], poses[static_cast<std::size_t>(e.to)]);
        };
        J.col(3 * (id - 1) + axis) = (error(1e-6) - error(-1e-6)) / 2e-6;
      }
    return J;
  };
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  for (const GraphEdge& e : graph.edges) H += jacobian(e).transpose() * e.information * jacobian(e);
  const Eigen::MatrixXd covariance = H.inverse();
  for (const GraphEdge& e : {edge(0, 15, {1, 2, 0.3}), edge(3, 12, {0, 1, -1}), edge(9, 2, {})}) {
    const Eigen::Matrix3d expected = jacobian(e) * covariance * jacobian(e).transpose();
    REQUIRE((optimizer.marginal(graph, e) - expected).norm() < 1e-5 * expected.norm());
  }
  const std::vector<Eigen::Matrix3d> of_poses = optimizer.marginals();
  for (Eigen::Index k = 1; k < static_cast<Eigen::Index>(graph.poses.size()); ++k) {
    const Eigen::Matrix3d expected = covariance.block<3, 3>(3 * (k - 1), 3 * (k - 1));
    REQUIRE((of_poses[static_cast<std::size_t>(k)] - expected).norm() < 1e-5 * expected.norm());
  }
}

TEST_CASE("public graphs reach the best chi2 that is known from every start") {
  const std::pair<const char*, double> graphs[] = {{"input_INTEL.g2o.xz", 215.8404},
                                                   {"g2o_intel.g2o.xz", 546.46112},
                                                   {"g2o_manhattanOlson3500.g2o.xz", 146.07662},
                                                   {"ring.g2o.xz", 11.16311},
                                                   {"sesync_CSAIL.g2o.xz", 40.55513}};
  for (const auto& [name, best] : graphs) {
    GraphFile file;
    try {
      file = parse_graph(read_file_bytes(shared_file(std::string("data/graphs/") + name)).bytes);
    } catch (const std::runtime_error&) {
      WARN("no data of " << name << ": skipped");
      continue;
    }
    INFO(name);
    PoseGraph chordal = file.graph, tree = file.graph;
    SparseOptimizer optimizer(file.graph);
    optimizer.initialize_chordal(chordal);
    initialize_from_tree(tree);
    for (PoseGraph* start : {&chordal, &tree, &file.graph}) REQUIRE(optimizer.optimize(*start, {100, 1e-7, 0.0}).chi2_after < best * (1 + 1e-6));
  }
}
