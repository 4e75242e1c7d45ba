// SPDX-License-Identifier: BSD-3-Clause
/// The estimator's session and a mirror on two in-process buses; the test carries messages across and loses some.
#include "common/bus/graph_mirror.hpp"

#include <limits>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/estimator_session.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

/// Carries what one transport says on some channels to another; `lose` decides about each message by its number.
struct Wire {
  Wire(Transport& from, Transport& to, const std::vector<std::string>& channels) {
    for (const std::string& name : channels)
      from.subscribe(name, [this, &to](const std::string& channel, const void* bytes, int size) {
        const int number = count[channel]++;
        if (!lose || !lose(channel, number)) to.publish(channel, bytes, size);
      });
  }
  std::map<std::string, int> count;
  std::function<bool(const std::string& channel, int number)> lose;
};

struct Pair {
  explicit Pair(EstimatorConfig config = {}) : session(estimator_bus, config) {
    drain();
  }
  void join() {
    mirror = std::make_unique<GraphMirror>(mirror_bus);
    mirror->on_node = [this](const MirrorNode& node) { seen.push_back(node.id); };
    mirror->on_reset = [this] { seen.clear(); };
  }
  /// Drives `steps` nodes of half a metre on a ring of 12 m, ten scans a second.
  void drive(int steps) {
    for (int k = 0; k < steps; ++k) {
      Scan scan;
      scan.utime = utime += 500'000;
      scan.ranges_m = {1.0f};
      std::vector<MotionMeasurement> measurements;
      if (started) measurements.push_back({{0.5, 0, 2 * kPi / 24 + 0.003}, 1e4 * Eigen::Matrix3d::Identity()});
      started = true;
      session.step(scan, {}, measurements, Verdict::kOk);
      drain();
    }
  }
  void close(NodeId from, NodeId to) {
    LoopProposal loop;
    loop.from = from;
    loop.to = to;
    for (NodeId k = from; k < to; ++k) loop.T_from_to = loop.T_from_to * Pose2(0.5, 0, 2 * kPi / 24);
    loop.information = 1e4 * Eigen::Matrix3d::Identity();
    loop.verdict = Verdict::kOk;
    session.add_loop(loop);
    drain();
  }
  void drain() {
    for (int round = 0; round < 4; ++round) {
      while (estimator_side.poll(0)) {
      }
      while (mirror_side.poll(0)) {
      }
      session.tick();
    }
  }
  bool has_edge(EdgeId id) const {
    const auto& edges = mirror->edges();
    return std::any_of(edges.begin(), edges.end(), [id](const GraphEdge& edge) { return edge.id == id; });
  }
  bool agree() const {
    const PoseGraph& graph = session.estimator().graph();
    if (mirror->nodes().size() != graph.poses.size() || mirror->edges().size() != graph.edges.size()) return false;
    for (std::size_t k = 0; k < graph.poses.size(); ++k)
      if (distance(mirror->nodes()[k].T_map_base, graph.poses[k]) > 0.003) return false;
    for (const GraphEdge& edge : graph.edges)
      if (!has_edge(edge.id)) return false;
    return true;
  }

  Transport estimator_side{"memq://"}, mirror_side{"memq://"};
  Bus estimator_bus{estimator_side, "estimator"}, mirror_bus{mirror_side, "mirror"};
  Wire down{estimator_side, mirror_side, {channel::kNode, channel::kGraph, channel::kPose}};
  Wire up{mirror_side, estimator_side, {channel::kSyncRequest}};
  EstimatorSession session;
  std::unique_ptr<GraphMirror> mirror;
  std::vector<NodeId> seen;
  std::int64_t utime = 1'000'000'000;
  bool started = false;
};

EstimatorConfig trusting() {
  EstimatorConfig config;
  config.confirmations = 0;
  config.postpone = 1;
  return config;
}

bool in_order(const std::vector<NodeId>& ids) {
  for (std::size_t k = 0; k < ids.size(); ++k)
    if (ids[k] != static_cast<NodeId>(k)) return false;
  return true;
}

}  // namespace

TEST_CASE("a mirror that hears everything agrees with the estimator, through a loop closure") {
  Pair pair(trusting());
  pair.join();
  pair.drive(40);
  pair.close(2, 26);
  REQUIRE(pair.session.estimator().accepted() == 1);
  REQUIRE(pair.mirror->epoch() == 1);
  REQUIRE(pair.mirror->complete());
  REQUIRE(pair.agree());
  REQUIRE(in_order(pair.seen));
  REQUIRE(pair.seen.size() == 40);
}

TEST_CASE("a latecomer asks and has everything, also the loops before its time") {
  Pair pair(trusting());
  pair.drive(40);
  pair.close(2, 26);
  pair.join();
  pair.drive(4);  // it sees a gap, asks, is answered piece by piece
  REQUIRE(pair.mirror->complete());
  REQUIRE(pair.agree());
  REQUIRE(in_order(pair.seen));
  REQUIRE(pair.seen.size() == 44);
}

TEST_CASE("a lost NODE is asked for again and those after it wait for their turn") {
  Pair pair;
  pair.join();
  pair.down.lose = [](const std::string& channel, int number) { return channel == "NODE" && number == 7; };
  pair.drive(20);
  REQUIRE(pair.agree());
  REQUIRE(in_order(pair.seen));
  REQUIRE(pair.mirror_bus.inputs().at("NODE").gaps == 1);
}

TEST_CASE("a lost GRAPH is noticed by its number and made good by a snapshot") {
  Pair pair(trusting());
  pair.join();
  pair.drive(30);
  int closures = 0;
  pair.down.lose = [&](const std::string& channel, int) { return channel == "GRAPH" && closures++ == 0; };
  pair.close(2, 26);  // this one, with the edge and all moved poses, is lost
  REQUIRE_FALSE(pair.agree());
  pair.drive(4);
  REQUIRE(pair.mirror->complete());
  REQUIRE(pair.agree());
  REQUIRE(pair.mirror_bus.inputs().at("GRAPH").gaps >= 1);
}

TEST_CASE("every third message lost in both directions, and still whole soon after the storm") {
  Pair pair(trusting());
  pair.join();
  pair.down.lose = pair.up.lose = [](const std::string&, int number) { return number % 3 == 1; };
  pair.drive(40);
  pair.close(2, 26);
  pair.drive(10);
  pair.down.lose = pair.up.lose = nullptr;
  pair.drive(6);  // 3 seconds
  REQUIRE(pair.mirror->complete());
  REQUIRE(pair.agree());
  REQUIRE(in_order(pair.seen));
}

TEST_CASE("another session's node 0 makes the mirror forget the old graph") {
  Pair pair;
  pair.join();
  pair.drive(10);
  Bus other_bus(pair.estimator_side, "other estimator");
  EstimatorSession other(other_bus, {});
  Scan scan;
  scan.utime = 9'000'000'000;
  scan.ranges_m = {1.0f};
  other.step(scan, {}, {}, Verdict::kFirst);
  while (pair.estimator_side.poll(0)) {
  }
  while (pair.mirror_side.poll(0)) {
  }
  REQUIRE(pair.mirror->nodes().size() == 1);
  REQUIRE(pair.mirror->nodes()[0].utime == 9'000'000'000);
  REQUIRE(pair.mirror->edges().empty());
}

TEST_CASE("garbled graph messages are refused and counted, and leave what is known alone") {
  Pair pair;
  pair.join();
  pair.drive(10);
  const auto bad = [&] { return pair.mirror_bus.inputs().at("GRAPH").bad; };
  graph_update_t update{};
  update.seq = 11;
  update.nnodes = 10;
  update.nchunks = 1;
  graph_edge_t edge{};
  edge.id = 100;
  edge.from_node = 3;
  edge.to_node = 4;
  edge.kind = graph_edge_t::LOOP;
  Bus liar(pair.mirror_side, "liar");
  const auto refused = [&](const std::function<void(graph_update_t&)>& garble) {
    graph_update_t garbled = update;
    garbled.edges = {edge};
    garbled.nedges = 1;
    garble(garbled);
    const auto before = bad();
    liar.publish(channel::kGraph, garbled);
    while (pair.mirror_side.poll(0)) {
    }
    return bad() == before + 1 && !pair.has_edge(100);
  };
  REQUIRE(refused([](graph_update_t& m) { m.chunk = 1; }));
  REQUIRE(refused([](graph_update_t& m) { m.nchunks = 0; }));
  REQUIRE(refused([](graph_update_t& m) { m.nnodes = -1; }));
  REQUIRE(refused([](graph_update_t& m) { m.edges[0].from_node = -5; }));
  REQUIRE(refused([](graph_update_t& m) { m.edges[0].to_node = 3; }));
  REQUIRE(refused([](graph_update_t& m) { m.edges[0].to_node = 1'000'000'000'000; }));
  REQUIRE(refused([](graph_update_t& m) { m.edges[0].information[2] = std::numeric_limits<double>::quiet_NaN(); }));
  REQUIRE(refused([](graph_update_t& m) { m.edges[0].T_from_to[0] = std::numeric_limits<double>::infinity(); }));
  REQUIRE(refused([](graph_update_t& m) {
    m.poses = {node_pose_t{}};
    m.poses[0].id = -1;
    m.nposes = 1;
  }));
  pair.drive(3);
  REQUIRE(pair.agree());
}
