// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/overlap.hpp"

#include "common/graph/estimator.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A robot that has circled in a furnished room; its poses are wrong by a few centimetres.
struct Circled {
  explicit Circled(const Plan& plan, int count) {
    RandomStream random(77, RandomStreamId::kLaser);
    const SensorInfo sensor = short_laser();
    Pose2 T(0, -1, 0);
    for (int k = 0; k < count; ++k, T = T * Pose2(0.3, 0, 2 * kPi / 21)) {
      truth.push_back(T);
      const Pose2 wrong = T * Pose2(0.02 * random.normal(), 0.02 * random.normal(), 0.01 * random.normal());
      nodes.push_back({k ? wrong : T, orient(see(plan, sensor, T, &random), sensor, {0.01, 1e-3}, 10.0, 0.03), {0, 0}});
    }
  }
  std::vector<Pose2> truth;
  std::vector<Keyframe> nodes;
};

}  // namespace

TEST_CASE("scans that see the same surfaces measure each other to millimetres, whatever their poses said") {
  const Circled run(furnished_room(), 42);
  const std::vector<GraphEdge> edges = measure_overlaps(run.nodes);
  REQUIRE(edges.size() > 200);
  for (const GraphEdge& edge : edges) {
    REQUIRE(edge.to - edge.from >= 2);
    const Pose2 truth = between(run.truth[static_cast<std::size_t>(edge.from)], run.truth[static_cast<std::size_t>(edge.to)]);
    REQUIRE_THAT(edge.T_from_to, IsNear(truth, 0.015, 0.006));
  }
}

TEST_CASE("overlaps claim nothing along a bare corridor") {
  const Plan plan = corridor();
  const SensorInfo sensor = short_laser();
  std::vector<Keyframe> nodes;
  for (int k = 0; k < 10; ++k) {
    const Pose2 T(0.3 * k, 0, 0);
    nodes.push_back({T, orient(see(plan, sensor, T), sensor, {0.01, 1e-3}, 10.0, 0.03), {0, 0}});
  }
  const std::vector<GraphEdge> edges = measure_overlaps(nodes);
  REQUIRE_FALSE(edges.empty());
  for (const GraphEdge& edge : edges) {
    REQUIRE(edge.information(0, 0) < 1e-6 * edge.information(1, 1));
    REQUIRE(edge.T_from_to.x == Approx(0.3 * static_cast<double>(edge.to - edge.from)).margin(0.01));
  }
}

TEST_CASE("scans of two buildings, of nothing, or far apart have no overlaps") {
  const SensorInfo sensor = short_laser();
  Plan hall;
  add_box(hall, -9, -7, 8, 9);
  const auto keyframe = [&](const Plan& plan, const Pose2& T) {
    return Keyframe{T, orient(see(plan, sensor, T), sensor, {0.01, 1e-3}, 10.0, 0.03), {0, 0}};
  };
  const Keyframe room = keyframe(furnished_room(), {}), other = keyframe(hall, {}), nothing{{}, {}, {0, 0}};
  REQUIRE(measure_overlaps({room, nothing, other, nothing}).empty());
  const Keyframe far = keyframe(furnished_room(), {30, 0, 0});
  REQUIRE(measure_overlaps({room, nothing, far}).empty());
  REQUIRE(measure_overlaps({}).empty());
}
