// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/loop_detector.hpp"

#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A robot that circles in a plan with drifting odometry; every step is a node.
struct Circle {
  Circle(const Plan& plan, LoopDetectorConfig config = {}) : detector(config, 0.01, 10.0), plan_(plan) { graph.edges.reserve(1000); }

  std::vector<LoopProposal> step(const Pose2& motion, const Pose2& drift) {
    const bool first = truth.empty();
    truth.push_back(first ? start : truth.back() * motion);
    estimate.push_back(first ? start : estimate.back() * motion * drift);
    const auto id = static_cast<NodeId>(truth.size()) - 1;
    detector.add_node(id, estimate.back(), see(plan_, sensor, truth.back(), &random), sensor);
    if (!first) graph.edges.push_back(edge(id - 1, id, motion * drift));
    std::vector<const GraphEdge*> edges;
    for (const GraphEdge& e : graph.edges) edges.push_back(&e);
    return detector.detect(edges);
  }

  Pose2 start{0, -1, 0};
  LoopDetector detector;
  SensorInfo sensor = short_laser();
  RandomStream random{111, RandomStreamId::kLaser};
  std::vector<Pose2> truth, estimate;
  PoseGraph graph;

 private:
  Plan plan_;
};

}  // namespace

TEST_CASE("a place seen before is recognised and measured despite a third of a metre of drift") {
  Circle circle(furnished_room());
  int usable = 0;
  for (int k = 0; k < 60; ++k)
    for (const LoopProposal& loop : circle.step({0.3, 0, 2 * kPi / 21}, {0.01, 0.005, 0.006})) {
      const auto from = static_cast<std::size_t>(loop.from), to = static_cast<std::size_t>(loop.to);
      REQUIRE(loop.from < loop.to);
      REQUIRE(std::find(loop.affected.begin(), loop.affected.end(), loop.from) != loop.affected.end());
      if (!is_usable(loop.verdict)) continue;
      ++usable;
      // The affected nodes lie as the drifted graph has them, so the answer is as wrong as they are among themselves.
      REQUIRE_THAT(loop.T_from_to, IsNear(between(circle.truth[from], circle.truth[to]), 0.12, 0.05));
    }
  REQUIRE(usable >= 10);
  REQUIRE(distance(circle.truth.back(), circle.estimate.back()) > 0.3);
}

TEST_CASE("nothing is proposed before the robot has driven the delay") {
  LoopDetectorConfig config;
  config.delay_m = 8.0;
  Circle circle(furnished_room(), config);
  for (int k = 0; k < 26; ++k) REQUIRE(circle.step({0.3, 0, 2 * kPi / 21}, {}).empty());  // 7.5 m
}

TEST_CASE("an old node behind a wall is not a candidate") {
  // Two rooms with a closed wall between: the robot is carried from the left to the right one, 2.2 m from its old nodes.
  Plan plan;
  add_box(plan, -6, -3, 0, 3);
  add_box(plan, 0.1, -3, 6, 3);
  LoopDetectorConfig config;
  config.delay_m = 2.0;
  config.beam_near_m = 0.3;
  config.cooldown_m = 0;
  Circle circle(plan, config);
  circle.start = {-1.2, -1, kPi / 2};
  for (int k = 0; k < 6; ++k) circle.step({0.3, 0, 0}, {});
  circle.step({0, -2.2, 0}, {});
  for (int k = 0; k < 8; ++k)
    for (const LoopProposal& loop : circle.step({k % 2 ? 0.3 : -0.3, 0, 0}, {})) REQUIRE(loop.from >= 6);
}

TEST_CASE("along a bare corridor an accidental loop claims nothing along the walls") {
  LoopDetectorConfig config;
  config.delay_m = 3.0;
  config.cooldown_m = 0;
  Circle circle(corridor(), config);
  circle.start = {0, 0, 0};
  int looked = 0;
  for (int k = 0; k < 40; ++k)
    for (const LoopProposal& loop : circle.step({k < 20 ? 0.3 : -0.3, 0, 0}, {})) {
      ++looked;
      REQUIRE(loop.verdict != Verdict::kOk);
      REQUIRE(loop.information(0, 0) < 1e-4 * (loop.information(1, 1) + 1));
    }
  REQUIRE(looked > 0);
}

TEST_CASE("nodes that see nothing and a cleared detector propose nothing usable") {
  LoopDetectorConfig config;
  config.delay_m = 1.0;
  LoopDetector detector(config, 0.01, 10.0);
  const SensorInfo sensor = short_laser();
  for (NodeId id = 0; id < 20; ++id) {
    detector.add_node(id, {id < 10 ? 0.3 * static_cast<double>(id) : 0.3 * static_cast<double>(20 - id), 0, 0}, Scan(), sensor);
    for (const LoopProposal& loop : detector.detect({})) REQUIRE_FALSE(is_usable(loop.verdict));
  }
  detector.clear();
  detector.add_node(0, {}, Scan(), sensor);
  REQUIRE(detector.detect({}).empty());
}
