// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/known_space.hpp"

#include <Eigen/LU>

#include "common/graph/estimator.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

Eigen::Matrix3d diagonal(double x, double y, double heading) { return Eigen::Vector3d(x, y, heading).asDiagonal(); }

/// A robot on a ring of 7.5 m in steps of 0.1 m that, when asked, knows where it is to half a centimetre.
struct Circler {
  explicit Circler(bool knows_places) : localize(knows_places ? Localize([this](const auto& known, const auto& expected) { return look(known, expected); }) : Localize()) {
    estimator.move({});
  }
  void drive_round() {
    for (int k = 0; k < 75; ++k) {
      const Pose2 motion(0.1, 0, 2 * kPi / 75);
      T_world_base = T_world_base * motion;
      const Pose2 wrong = motion * Pose2(0.0002, 0, 0.0002);
      step = estimator.move({{wrong, diagonal(4e5, 4e5, 4e6)}}, localize);
      if (step.is_new_node) T_world_node.push_back(T_world_base);
    }
  }
  Localized look(const std::vector<NodeId>& known, const Anchorage&) {
    const Pose2 error(0.005 * normal(random), 0.005 * normal(random), 0.002 * normal(random));
    return {true, AnchorFix{between(T_world_node[static_cast<std::size_t>(known.front())], T_world_base * error), diagonal(4e4, 4e4, 2.5e5)}};
  }
  double error_m() const { return distance(step.T_map_base, T_world_base); }

  Localize localize;
  GraphEstimator estimator{EstimatorConfig()};
  GraphEstimator::Step step;
  Pose2 T_world_base;
  std::vector<Pose2> T_world_node{{}};
  std::mt19937_64 random{71};
  std::normal_distribution<double> normal;
};

}  // namespace

TEST_CASE("nodes are in reach when they are near and look the same way") {
  const std::vector<Pose2> nodes = {{0, 0, 0}, {0.5, 0, 0}, {0.1, 0, 3}, {0.2, 0.1, 0.7}, {0, 0.7, 0}, {0.1, 0, 0.1}};
  REQUIRE(nodes_in_reach(nodes, {0, 0, 0}) == std::vector<NodeId>{0, 5, 1, 3});
  REQUIRE(nodes_in_reach({}, {0, 0, 0}).empty());
}

TEST_CASE("an expected place and a fix are averaged by what they know, and not when they contradict each other") {
  const Anchorage expected{7, {1, 0, 0}, diagonal(0.04, 0.0001, 0.01)};
  const auto place = combine(expected, {{1.2, 0.1, 0}, diagonal(25, 100, 1e-9)});
  REQUIRE(place);
  CHECK(place->node == 7);
  CHECK_THAT(place->T_node_base, IsNear({1.1, 0.001, 0}, 1e-4, 1e-4));
  CHECK(place->covariance(0, 0) == Approx(0.02).epsilon(0.01));
  CHECK_FALSE(combine(expected, {{1, 0.1, 0}, diagonal(25, 1e6, 100)}));
  SECTION("where the fix saw nothing the expectation stands") {
    const auto blind = combine(expected, {{3, 0, 0}, diagonal(0, 1e4, 0)});
    REQUIRE(blind);
    CHECK_THAT(blind->T_node_base, IsNear({1, 0, 0}, 1e-6, 1e-6));
  }
}

TEST_CASE("an edge between old nodes is as unsure as the way and the fix together") {
  std::mt19937_64 random(72);
  std::normal_distribution<double> normal;
  const Anchorage came{3, {2, 1, 0.6}, diagonal(1e-4, 4e-4, 1e-4)};
  const AnchorFix fix{{0.5, -0.3, -0.4}, diagonal(1e4, 2500, 4e4)};
  const GraphEdge edge = passing_edge(came, 9, fix);
  REQUIRE(edge.from == 3);
  REQUIRE(edge.to == 9);
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 20'000;
  for (int k = 0; k < kDraws; ++k) {
    const Pose2 way(came.T_node_base.vector() + Eigen::Vector3d(0.01 * normal(random), 0.02 * normal(random), 0.01 * normal(random)));
    const Pose2 seen = fix.T_node_base * Pose2(0.01 * normal(random), 0.02 * normal(random), 0.005 * normal(random));
    GraphEdge drawn = edge;
    drawn.T_from_to = way * seen.inverse();
    const Eigen::Vector3d e = edge_error(edge, {}, drawn.T_from_to);
    cov += e * e.transpose() / kDraws;
  }
  CHECK((cov * edge.information - Eigen::Matrix3d::Identity()).norm() < 0.1);
}

TEST_CASE("a robot that drives in circles makes nodes once, and is no worse off than one that makes them for ever") {
  Circler thrifty(true), wasteful(false);
  std::size_t nodes = 0, edges = 0;
  for (int round = 0; round < 40; ++round) {
    thrifty.drive_round();
    wasteful.drive_round();
    if (round == 5) nodes = thrifty.estimator.graph().poses.size(), edges = thrifty.estimator.graph().edges.size();
  }
  INFO(nodes << " nodes, " << edges << " edges after 6 rounds, " << thrifty.estimator.graph().edges.size() << " edges after 40");
  CHECK(thrifty.estimator.graph().poses.size() == nodes);
  CHECK(thrifty.estimator.graph().edges.size() <= edges + edges / 10);
  CHECK(wasteful.estimator.graph().poses.size() > 5 * nodes);
  CHECK(thrifty.error_m() < 0.05);
  CHECK(wasteful.error_m() > 0.2);  // nobody told it of a loop
}

TEST_CASE("a scan that shows something new makes a node where the place is full, up to twice as many") {
  GraphEstimator estimator{EstimatorConfig()};
  estimator.move({});
  const Localize never = [](const auto&, const auto&) { return Localized(); };
  bool forth = true;
  for (int k = 0; k < 60; ++k, forth = !forth) estimator.move({{{forth ? 0.31 : -0.31, 0, 0}, diagonal(1e5, 1e5, 1e6)}}, never);
  CHECK(estimator.graph().poses.size() == 2 * static_cast<std::size_t>(EstimatorConfig().full_at));
}
