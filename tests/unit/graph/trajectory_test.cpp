// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/trajectory.hpp"

#include "tests/support/matchers.hpp"

using namespace modslam;

TEST_CASE("what two nodes moved apart is handed out over the scans between them") {
  // Thought: 1 m from node 0 to node 1. In the end they stand 1.2 m apart.
  std::vector<TrackedPose> tracked;
  for (int i = 0; i < 10; ++i) tracked.push_back({i, 0, {0.1 * i, 0, 0}, {}, -1, {}});
  tracked.push_back({10, 1, {}, {}, 0, {1, 0, 0}});
  const auto path = final_path(tracked, {{0, {0, 0, 0}}, {1, {1.2, 0, 0}}});
  for (int i = 0; i <= 10; ++i) REQUIRE_THAT(path[i], IsNear({0.12 * i, 0, 0}, 1e-6, 1e-12));
}

TEST_CASE("the final path has no jump where the node changes, however the nodes were moved") {
  std::mt19937_64 random(52);
  std::uniform_real_distribution<double> small(-1, 1);
  std::vector<TrackedPose> tracked;
  std::map<NodeId, Pose2> T_map_node;
  Pose2 T_map_base, T_node_base, moved;
  for (int i = 0; i < 400; ++i) {
    const bool is_node = i % 20 == 0;
    const Pose2 T_before_base = T_node_base;
    if (is_node) {
      T_node_base = {};
      moved = Pose2(moved.vector() +
                    0.02 * Eigen::Vector3d(small(random), small(random), small(random)));
      T_map_node[i / 20] = moved * T_map_base;
    }
    tracked.push_back({i, i / 20, T_node_base, T_map_base, is_node ? i / 20 - 1 : -1, T_before_base});
    const Pose2 step(0.05, 0, 0.05 * small(random));
    T_map_base = T_map_base * step;
    T_node_base = T_node_base * step;
  }
  const auto path = final_path(tracked, T_map_node);
  const auto hung = [&](int i) { return T_map_node[tracked[i].node] * tracked[i].T_node_base; };
  double jump = 0, hung_jump = 0;  // how much longer than a step the longest one is
  for (int i = 1; i < 400; ++i) {
    jump = std::max(jump, distance(path[i - 1], path[i]) - 0.05);
    hung_jump = std::max(hung_jump, distance(hung(i - 1), hung(i)) - 0.05);
    if (i % 20 == 0) REQUIRE_THAT(path[i], IsNear(T_map_node[i / 20], 1e-9, 1e-9));
  }
  REQUIRE(jump < hung_jump / 5);
}

TEST_CASE("scans that became nodes are put back in where their pose was lost, and nothing else is") {
  std::vector<TrackedPose> whole;
  std::map<NodeId, std::int64_t> node_utimes;
  std::map<EdgeId, GraphEdge> edges;
  for (int i = 0; i < 60; ++i) {
    const bool is_node = i % 10 == 0;
    const NodeId node = i / 10;
    whole.push_back({i, node, {0.1 * (i % 10), 0, 0}, {}, is_node ? node - 1 : -1, is_node && i > 0 ? Pose2(1, 0.01 * i, 0) : Pose2()});
    if (is_node) node_utimes[node] = i;
    if (is_node && i > 0) edges[node] = {node, node - 1, node, EdgeKind::kSequence, whole.back().T_before_base, Eigen::Matrix3d::Identity()};
  }
  edges[100] = {100, 0, 5, EdgeKind::kLoop, {3, 3, 3}, Eigen::Matrix3d::Identity()};
  edges[3].information *= 1e-6;  // nobody knows how the robot came to node 3
  std::vector<TrackedPose> lossy;
  for (const TrackedPose& pose : whole)
    if (pose.utime % 20 != 10 && pose.utime != 50) lossy.push_back(pose);  // of nodes 1, 3 and 5
  lossy.erase(lossy.end() - 9, lossy.end());                                // nothing hangs on the last one
  add_lost_nodes(lossy, node_utimes, edges);
  std::vector<std::int64_t> utimes;
  for (const TrackedPose& pose : lossy) {
    const TrackedPose& before = whole[static_cast<std::size_t>(pose.utime)];
    utimes.push_back(pose.utime);
    CHECK(pose.node_before == before.node_before);
    CHECK_THAT(pose.T_before_base, IsNear(before.T_before_base, 1e-12, 1e-12));
  }
  CHECK(utimes.size() == 50);
  CHECK(std::is_sorted(utimes.begin(), utimes.end()));
  CHECK(std::count(utimes.begin(), utimes.end(), 30) == 0);
  CHECK(utimes.back() == 50);
}

TEST_CASE("a robot that stands still, or whose node is unknown, gets a pose all the same") {
  const std::vector<TrackedPose> tracked = {
      {0, -1, {}, {5, 6, 1}, -1, {}}, {1, 0, {}, {}, -1, {}}, {2, 0, {}, {}, -1, {}}, {3, 9, {1, 0, 0}, {7, 8, 2}, -1, {}}};
  const auto path = final_path(tracked, {{0, {1, 2, 0.5}}, {1, {1, 2, 0.5}}});
  REQUIRE_THAT(path[0], IsNear({5, 6, 1}, 1e-12, 1e-12));
  REQUIRE_THAT(path[1], IsNear({1, 2, 0.5}, 1e-12, 1e-12));
  REQUIRE_THAT(path[2], IsNear({1, 2, 0.5}, 1e-12, 1e-12));
  REQUIRE_THAT(path[3], IsNear({7, 8, 2}, 1e-12, 1e-12));
  REQUIRE(final_path({}, {}).empty());
}

TEST_CASE("poses find their scans in order, though stamps repeat, step back or are missing") {
  using Indices = std::vector<int>;
  REQUIRE(match_in_order({10, 20, 30}, {10, 20, 30}) == Indices{0, 1, 2});
  REQUIRE(match_in_order({10, 20, 30}, {10, 30}) == Indices{0, -1, 1});
  REQUIRE(match_in_order({10, 20, 20, 30}, {20, 20}) == Indices{-1, 0, 1, -1});
  REQUIRE(match_in_order({10, 30, 20, 30, 40}, {10, 30, 20, 30, 40}) == Indices{0, 1, 2, 3, 4});
  REQUIRE(match_in_order({10, 20}, {15, 20}) ==
          Indices{-1, 1});  // a pose of a scan that is not in the log
  REQUIRE(match_in_order({}, {10}).empty());
}

TEST_CASE(
    "a scan without a pose lies between its neighbours by index; at the ends it takes the "
    "nearest") {
  const std::vector<Pose2> poses = {{1, 0, 0}, {4, 0, 0.3}};
  const auto filled = fill_by_index({-1, 0, -1, -1, 1, -1}, poses);
  REQUIRE(filled.size() == 6);
  REQUIRE_THAT(filled[0], IsNear({1, 0, 0}, 1e-12, 1e-12));
  REQUIRE_THAT(filled[2], IsNear({2, 0, 0.1}, 1e-12, 1e-12));
  REQUIRE_THAT(filled[3], IsNear({3, 0, 0.2}, 1e-12, 1e-12));
  REQUIRE_THAT(filled[5], IsNear({4, 0, 0.3}, 1e-12, 1e-12));
  REQUIRE(fill_by_index({-1, -1}, {}).empty());
}
