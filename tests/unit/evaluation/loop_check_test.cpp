// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/loop_check.hpp"

#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

TEST_CASE("a loop that is off is found, with its chi-square and its metres") {
  const std::map<NodeId, Pose2> nodes = {{0, {}}, {1, {1, 0, 0}}, {2, {2, 0, kPi / 2}}};
  const std::vector<GraphEdge> edges = {edge(0, 1, {5, 0, 0}), edge(0, 2, {2, 0, kPi / 2}, EdgeKind::kLoop), edge(1, 2, {1, 0.5, kPi / 2}, EdgeKind::kLoop),
                                        edge(1, 7, {}, EdgeKind::kLoop)};
  const LoopCheck check = check_loops(edges, nodes);
  REQUIRE(check.loops == 2);
  REQUIRE(check.worst_m == Approx(0.5));
  REQUIRE(check.worst_chi2 == Approx(0.25 * 100));
  REQUIRE(check.from == 1);
}

TEST_CASE("a loop that is blind along a corridor is not blamed for its place there") {
  GraphEdge blind = edge(0, 1, {3, 0.1, 0}, EdgeKind::kLoop);
  blind.information = Eigen::Vector3d(1, 400, 400).asDiagonal();
  const LoopCheck check = check_loops({blind}, {{0, {}}, {1, {1, 0, 0}}});
  REQUIRE(check.worst_m == Approx(0.1));
  REQUIRE(check_loops({}, {}).loops == 0);
}
