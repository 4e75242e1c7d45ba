// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/components.hpp"

#include "common/graph/estimator.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

const Eigen::Matrix3d kSure = Eigen::Vector3d(1e4, 1e4, 4e4).asDiagonal();

/// Ten nodes in a row, half a metre apart; then the robot is carried away and makes ten more.
GraphEstimator carried_away() {
  GraphEstimator estimator{EstimatorConfig()};
  estimator.move({});
  for (int k = 1; k < 10; ++k) estimator.move({{{0.5, 0, 0}, kSure}});
  estimator.begin_apart();
  for (int k = 11; k < 20; ++k) estimator.move({{{0.5, 0, 0.1}, kSure}});
  return estimator;
}

/// The new row begins at node 4, looking backwards.
LoopProposal loop(NodeId from, NodeId to, const GraphEstimator& estimator, double aside_m = 0) {
  const auto& poses = estimator.graph().poses;
  const Pose2 T_map_to = Pose2(2, aside_m, kPi) * between(poses[10], poses[static_cast<std::size_t>(to)]);
  LoopProposal out;
  out.from = from;
  out.to = to;
  out.T_from_to = between(poses[static_cast<std::size_t>(from)], T_map_to);
  out.information = 0.1 * kSure;
  out.verdict = Verdict::kOk;
  return out;
}

}  // namespace

TEST_CASE("parts of a graph are what edges other than breaks tie together") {
  const GraphEdge tie{0, 0, 1, EdgeKind::kSequence, {}, kSure}, gap{1, 1, 2, EdgeKind::kSequence, {}, break_information()},
      late{2, 3, 2, EdgeKind::kLoop, {}, kSure};
  REQUIRE(components(5, {&tie, &gap, &late}) == std::vector<NodeId>{0, 0, 2, 2, 4});
  REQUIRE(components(0, {}).empty());
  const GraphEdge blind_loop{3, 1, 2, EdgeKind::kLoop, {}, Eigen::Matrix3d::Zero()};
  REQUIRE_FALSE(is_break(blind_loop));
}

TEST_CASE("a robot that was carried away begins apart from the map and says so") {
  const GraphEstimator estimator = carried_away();
  CHECK(estimator.graph().poses.size() == 20);
  CHECK(estimator.part_of_robot() == 10);
  for (std::size_t k = 0; k < 10; ++k) CHECK(distance(estimator.graph().poses[k], estimator.graph().poses[15]) > 20);
}

TEST_CASE("loops that confirm each other bring a part to its place as a whole, and one alone does not") {
  GraphEstimator estimator = carried_away();
  CHECK(estimator.add_loop(loop(4, 12, estimator)) == LoopFate::kWaiting);
  CHECK(estimator.add_loop(loop(3, 14, estimator)) == LoopFate::kWaiting);
  CHECK(estimator.part_of_robot() == 10);
  SECTION("the third that agrees joins the parts") {
    CHECK(estimator.add_loop(loop(3, 17, estimator)) == LoopFate::kAccepted);
    CHECK(estimator.part_of_robot() == 0);
    CHECK_THAT(estimator.graph().poses[10], IsNear({2, 0, kPi}, 0.01, 0.01));
    CHECK_THAT(estimator.graph().poses[5], IsNear({2.5, 0, 0}, 0.01, 0.01));
  }
  SECTION("a third that tells another story does not") {
    CHECK(estimator.add_loop(loop(3, 17, estimator, 1.5)) == LoopFate::kWaiting);
    CHECK(estimator.part_of_robot() == 10);
  }
}
