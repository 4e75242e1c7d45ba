// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/estimator.hpp"

#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

MotionMeasurement measured(const Pose2& motion, double information = 1e5) {
  return {motion, Eigen::Vector3d(information, information, 4 * information).asDiagonal()};
}

/// A robot that has driven a ring of 24 m in steps of 0.4 m, twice around, with biased odometry; truth[k] is node k's place.
struct Ring {
  explicit Ring(EstimatorConfig config = {}) : estimator(config) {
    estimator.move({});
    truth.push_back({});
    for (int k = 1; k < 120; ++k) {
      const Pose2 motion(0.4, 0, 2 * kPi / 60);
      truth.push_back(truth.back() * motion);
      // Weak: a centimetre and a half a step, so that the ring does not close by itself.
      estimator.move({measured(motion * Pose2(0.004, 0, 0.004), 5e3)});
    }
    estimator.take_changes();
  }
  LoopProposal loop(NodeId from, NodeId to, const Pose2& error = {}) const {
    LoopProposal out;
    out.from = from;
    out.to = to;
    out.T_from_to = between(truth[static_cast<std::size_t>(from)], truth[static_cast<std::size_t>(to)]) * error;
    out.information = Eigen::Vector3d(1e4, 1e4, 4e4).asDiagonal();
    out.verdict = Verdict::kOk;
    return out;
  }
  double error_m(NodeId id) const {
    return distance(estimator.graph().poses[static_cast<std::size_t>(id)], truth[static_cast<std::size_t>(id)]);
  }
  GraphEstimator estimator;
  std::vector<Pose2> truth;
};

}  // namespace

TEST_CASE("the first scan is node 0 at the origin, small motions make no node, half a metre does") {
  GraphEstimator estimator{EstimatorConfig()};
  REQUIRE(estimator.move({}).is_new_node);
  REQUIRE_FALSE(estimator.move({measured({0.2, 0, 0})}).is_new_node);
  const GraphEstimator::Step step = estimator.move({measured({0.3, 0, 0})});
  REQUIRE(step.is_new_node);
  REQUIRE(step.node == 1);
  REQUIRE_THAT(step.T_map_base, IsNear({0.5, 0, 0}, 1e-6, 1e-6));
  REQUIRE(estimator.take_changes().added.size() == 1);
  REQUIRE(estimator.take_changes().empty());
}

TEST_CASE("a turn on the spot makes a node") {
  GraphEstimator estimator{EstimatorConfig()};
  estimator.move({});
  REQUIRE(estimator.move({measured({0, 0, 0.4})}).is_new_node);
}

TEST_CASE("the edge between two nodes carries what its steps knew together") {
  GraphEstimator estimator{EstimatorConfig()};
  estimator.move({});
  for (int k = 0; k < 4; ++k) estimator.move({measured({0.1, 0, 0}, 1e4)});
  const GraphEdge& e = estimator.graph().edges.at(0);
  // Four independent steps of 1 cm each: 2 cm together along the way.
  REQUIRE(e.information(0, 0) == Approx(1 / (3 * 1e-4 + 1e-6)).epsilon(0.35));
  REQUIRE(e.information(1, 1) < e.information(0, 0));  // headings err too, and levers turn that into metres
}

TEST_CASE("a loop that nobody confirms waits; enough of them that agree close the ring") {
  Ring ring;
  const double before_m = ring.error_m(110);
  REQUIRE(before_m > 1.0);
  REQUIRE(ring.estimator.add_loop(ring.loop(0, 60)) == LoopFate::kWaiting);
  REQUIRE(ring.estimator.add_loop(ring.loop(3, 63)) == LoopFate::kWaiting);
  REQUIRE(ring.error_m(110) == before_m);
  REQUIRE(ring.estimator.add_loop(ring.loop(7, 67)) == LoopFate::kAccepted);
  ring.estimator.settle(true);
  REQUIRE(ring.estimator.accepted() == 3);
  REQUIRE(ring.error_m(110) < 0.55 * before_m);
  const GraphChanges changes = ring.estimator.take_changes();
  REQUIRE(changes.added.size() == 3);
  REQUIRE(changes.moved.size() > 50);
  REQUIRE(std::is_sorted(changes.moved.begin(), changes.moved.end()));
  REQUIRE(ring.estimator.epoch() >= 1);
}

TEST_CASE("wrong loops that disagree with each other are never believed") {
  Ring ring;
  RandomStream random(91, RandomStreamId::kOdometry);
  for (int k = 0; k < 20; ++k) {
    const Pose2 wrong(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-1, 1));
    REQUIRE(ring.estimator.add_loop(ring.loop(2 * k, 60 + 2 * k, wrong)) != LoopFate::kAccepted);
  }
  REQUIRE(ring.estimator.accepted() == 0);
  REQUIRE(ring.estimator.graph().edges.size() == 119);
}

TEST_CASE("loops that are blind along a corridor do not confirm what another one claims there") {
  // The corridor runs along x of the map. The last loop is wrong by 1.4 m along it.
  Ring ring;
  const auto along_x = [&](NodeId to, double x_m) {
    return Pose2((rotation(-ring.truth[static_cast<std::size_t>(to)].heading) * Eigen::Vector2d(x_m, 0)).x(),
                 (rotation(-ring.truth[static_cast<std::size_t>(to)].heading) * Eigen::Vector2d(x_m, 0)).y(), 0);
  };
  const auto blind = [&](NodeId from, NodeId to) {
    LoopProposal loop = ring.loop(from, to);
    loop.verdict = Verdict::kDegenerate;
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R.topLeftCorner<2, 2>() = rotation(ring.truth[static_cast<std::size_t>(to)].heading);
    loop.information = R.transpose() * Eigen::Vector3d(0, 1e4, 4e4).asDiagonal() * R;
    return loop;
  };
  REQUIRE(ring.estimator.add_loop(blind(0, 60)) == LoopFate::kWaiting);
  REQUIRE(ring.estimator.add_loop(blind(3, 63)) == LoopFate::kWaiting);
  REQUIRE(ring.estimator.add_loop(ring.loop(7, 67, along_x(67, 1.4))) == LoopFate::kWaiting);
  REQUIRE(ring.estimator.accepted() == 0);
}

TEST_CASE("a wrong loop among good ones is refused or taken back, and the ring is right in the end") {
  EstimatorConfig config;
  config.confirmations = 0;  // believes whatever comes first: retraction must mend it
  Ring ring(config);
  ring.estimator.add_loop(ring.loop(10, 100, {1.5, -1.0, 0.4}));
  for (NodeId k = 0; k < 50; k += 5) ring.estimator.add_loop(ring.loop(k, 60 + k));
  ring.estimator.settle(true);
  REQUIRE(ring.estimator.retracted() >= 1);
  for (const GraphEdge& e : ring.estimator.graph().edges) REQUIRE_FALSE((e.from == 10 && e.to == 100));
  REQUIRE(ring.error_m(110) < 0.35);
  REQUIRE(ring.estimator.take_changes().retracted.size() == static_cast<std::size_t>(ring.estimator.retracted()));
}

TEST_CASE("proposals that are not meant to become edges, or of nodes that are not there, are refused") {
  Ring ring;
  LoopProposal bad = ring.loop(0, 60);
  for (const Verdict verdict : {Verdict::kInvalid, Verdict::kAmbiguous, Verdict::kLowOverlap, Verdict::kInconsistent, Verdict::kFailed}) {
    bad.verdict = verdict;
    REQUIRE(ring.estimator.add_loop(bad) == LoopFate::kRefused);
  }
  for (const auto& [from, to] : {std::pair<NodeId, NodeId>{-1, 5}, {5, 120}, {7, 7}, {1'000'000'000, 5}}) {
    bad = ring.loop(0, 60);
    bad.from = from;
    bad.to = to;
    REQUIRE(ring.estimator.add_loop(bad) == LoopFate::kRefused);
  }
}

TEST_CASE("both optimisers close the ring") {
  for (const char* method : {"gauss-newton", "toro"}) {
    EstimatorConfig config;
    config.method = method;
    config.confirmations = 0;
    Ring ring(config);
    const double before_m = ring.error_m(110);
    for (NodeId k = 0; k < 50; k += 5) ring.estimator.add_loop(ring.loop(k, 60 + k));
    ring.estimator.settle(true);
    INFO(method);
    REQUIRE(ring.error_m(110) < 0.5 * before_m);
  }
}

TEST_CASE("the sampled proposal is repeatable with its seed and spreads with its covariance") {
  EstimatorConfig config;
  config.proposal = "sampled";
  const auto drive = [&](std::int64_t seed) {
    config.seed = seed;
    GraphEstimator estimator(config);
    estimator.move({});
    GraphEstimator::Step step{};
    for (int k = 0; k < 10; ++k) step = estimator.move({measured({0.2, 0, 0}, 1e3)});
    return step.T_map_base;
  };
  REQUIRE_THAT(drive(1), IsNear(drive(1), 0, 0));
  REQUIRE(distance(drive(1), drive(2)) > 1e-3);
  REQUIRE_THAT(drive(1), IsNear({2, 0, 0}, 0.6, 0.5));
}

TEST_CASE("a loop that the scans' own comparison contradicts is taken back by the polish") {
  Ring ring;
  for (const NodeId k : {60, 66, 72, 78}) ring.estimator.add_loop(ring.loop(k - 60, k));
  ring.estimator.settle(true);
  const double wrong_m = 0.15;
  REQUIRE(ring.estimator.add_loop(ring.loop(25, 85, {wrong_m, 0, 0})) == LoopFate::kAccepted);
  ring.estimator.settle(true);
  ring.estimator.take_changes();
  std::vector<GraphEdge> overlaps;
  for (NodeId k = 20; k < 32; ++k) {
    const LoopProposal right = ring.loop(k, k + 60);
    overlaps.push_back({k, right.from, right.to, EdgeKind::kLoop, right.T_from_to, right.information});
  }
  const std::size_t edges = ring.estimator.graph().edges.size();
  ring.estimator.polish(overlaps);
  const GraphChanges changes = ring.estimator.take_changes();
  REQUIRE(changes.retracted.size() == 1);
  REQUIRE(ring.estimator.graph().edges.size() == edges - 1);
  REQUIRE(ring.estimator.graph().edges.back().from != 25);
  REQUIRE(distance(ring.estimator.graph().poses[85], ring.estimator.graph().poses[25]) < 0.05);
}

TEST_CASE("loops that are silent in a direction wait for one that is not, however many they are") {
  Ring ring;
  for (const NodeId k : {60, 62, 64, 66, 68}) {
    LoopProposal silent = ring.loop(k - 60, k);
    silent.verdict = Verdict::kDegenerate;
    REQUIRE(ring.estimator.add_loop(silent) == LoopFate::kWaiting);
  }
  ring.estimator.add_loop(ring.loop(10, 70));
  ring.estimator.add_loop(ring.loop(12, 72));
  REQUIRE(ring.estimator.add_loop(ring.loop(14, 74)) == LoopFate::kAccepted);
  LoopProposal silent = ring.loop(16, 76);
  silent.verdict = Verdict::kDegenerate;
  REQUIRE(ring.estimator.add_loop(silent) == LoopFate::kAccepted);  // the place is known now
}
