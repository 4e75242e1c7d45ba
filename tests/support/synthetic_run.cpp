// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/synthetic_run.hpp"

#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <modslam/parameters_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/process_status_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/sim_info_t.hpp>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "tests/support/synthetic_building.hpp"
#include "tests/support/synthetic_map.hpp"

namespace modslam::test {
namespace {

/// Figure-eight through (8, 4); one lap is a turn of `phase`.
Pose2 route(double phase) {
  const double x = 8 + 5.5 * std::sin(phase), y = 4 + 2.4 * std::sin(2 * phase);
  return {x, y, std::atan2(4.8 * std::cos(2 * phase), 5.5 * std::cos(phase))};
}

graph_edge_t make_edge(std::int64_t id, std::int64_t from, std::int64_t to, int kind,
                       const Pose2& T_from_to) {
  graph_edge_t edge{};
  edge.id = id;
  edge.from_node = from;
  edge.to_node = to;
  edge.kind = static_cast<std::int8_t>(kind);
  put(edge.T_from_to, T_from_to);
  put(edge.information, Eigen::Vector3d(2500, 2500, 10000).asDiagonal());
  return edge;
}

/// The estimator that drifts on the first lap, in the order its messages come.
class Estimator {
 public:
  Estimator(LogWriter& log, const SensorInfo& sensor) : log_(log), sensor_(sensor) {}

  /// @param T_map_true  where the robot is, for the optimiser that knows it.
  void step(const Scan& scan, const Pose2& T_map_true, bool publish_pose) {
    if (seq_ == 0) T_map_base_ = T_map_true;
    if (seq_ > 0) {
      Pose2 motion = between(T_map_true_, T_map_true);
      motion.x *= 1.01;  // what dead reckoning gets wrong
      motion.heading += 0.00012;
      T_map_base_ = T_map_base_ * motion;
    }
    T_map_true_ = T_map_true;
    if (nodes.empty() || distance(nodes.back(), T_map_base_) > 0.5) add_node(scan);
    if (publish_pose) publish(scan.utime);
    ++seq_;
  }

  /// What the optimiser says in the end.
  void settle(std::int64_t utime) {
    nodes = true_nodes;
    update(utime, {}, true);
  }

  std::vector<Pose2> nodes, true_nodes;
  int loop_edges = 0;

 private:
  void add_node(const Scan& scan) {
    graph_node_t node{};
    node.utime = scan.utime;
    node.id = static_cast<std::int64_t>(nodes.size());
    put(node.T_map_base, T_map_base_);
    node.sensor = to_message(sensor_, scan.utime);
    node.scan = to_message(scan);
    log_.write(scan.utime, channel::kNode, node);
    std::vector<graph_edge_t> edges;
    if (!nodes.empty()) {
      node_before_ = node.id - 1;
      T_before_base_ = between(nodes.back(), T_map_base_);
      edges.push_back(make_edge(edges_++, node.id - 1, node.id, graph_edge_t::SEQUENCE, T_before_base_));
    }
    nodes.push_back(T_map_base_);
    true_nodes.push_back(T_map_true_);
    update(scan.utime, edges, false);
    close_loop(scan.utime);
  }

  /// Proposes the nearest old node; then the graph is put where it belongs.
  void close_loop(std::int64_t utime) {
    const int to = static_cast<int>(nodes.size()) - 1;
    for (int from = 0; from < to - 30; ++from) {
      if (distance(true_nodes[from], true_nodes[to]) > 0.3 || to % 4 != 0) continue;
      loop_closure_t loop{};
      loop.utime = utime;
      loop.seq = ++proposals_;
      loop.from_node = from;
      loop.to_node = to;
      const bool good = proposals_ % 3 != 2;
      loop.verdict = good ? scan_match_t::OK : scan_match_t::AMBIGUOUS;
      log_.write(utime, channel::kLoop, loop);
      if (!good) return;
      nodes = true_nodes;
      T_map_base_ = T_map_true_;
      ++loop_edges;
      update(utime,
             {make_edge(edges_++, from, to, graph_edge_t::LOOP,
                        between(true_nodes[from], true_nodes[to]))},
             true);
      return;
    }
  }

  void update(std::int64_t utime, const std::vector<graph_edge_t>& edges, bool moved) {
    graph_update_t update{};
    update.utime = utime;
    update.seq = ++updates_;
    update.epoch = loop_edges;
    update.nchunks = 1;
    update.nnodes = static_cast<std::int64_t>(nodes.size());
    update.edges = edges;
    update.nedges = static_cast<int>(edges.size());
    for (std::size_t i = 0; moved && i < nodes.size(); ++i) {
      node_pose_t pose{};
      pose.id = static_cast<std::int64_t>(i);
      put(pose.T_map_base, nodes[i]);
      update.poses.push_back(pose);
    }
    update.nposes = static_cast<int>(update.poses.size());
    log_.write(utime, channel::kGraph, update);
  }

  void publish(std::int64_t utime) {
    pose_estimate_t pose{};
    pose.utime = utime;
    pose.seq = seq_;
    put(pose.T_map_base, T_map_base_);
    pose.verdict = seq_ == 0 ? scan_match_t::FIRST : scan_match_t::OK;
    pose.node_id = static_cast<std::int64_t>(nodes.size()) - 1;
    put(pose.T_node_base, between(nodes.back(), T_map_base_));
    pose.node_before = std::exchange(node_before_, -1);
    put(pose.T_before_base, T_before_base_ * between(nodes.back(), T_map_base_));
    log_.write(utime, channel::kPose, pose);
  }

  LogWriter& log_;
  SensorInfo sensor_;
  Pose2 T_map_base_, T_map_true_, T_before_base_;
  std::int64_t node_before_ = -1;  ///< of a scan that has just become a node
  std::int64_t seq_ = 0, edges_ = 0, updates_ = 0, proposals_ = 0;
};

void write_head(LogWriter& log, const SensorInfo& sensor, std::int64_t utime) {
  log.write(utime, channel::kSensorInfo, to_message(sensor, utime));
  sim_info_t sim{};
  sim.utime = utime;
  sim.world = "two_rooms.geojson";
  sim.route = "figure_eight";
  sim.noise = "none";
  sim.seed = 7;
  log.write(utime, channel::kSimInfo, sim);
  for (const char* name : {"scan_matcher", "graph_optimizer"}) {
    parameters_t parameters{};
    parameters.name = name;
    parameters.toml = "[launch]\nestimator = \"graph_optimizer\"\nsemantics = true\n";
    log.write(utime, channel::kParameters, parameters);
  }
}

void write_status(LogWriter& log, std::int64_t utime) {
  for (const char* name : {"scan_matcher", "graph_optimizer"}) {
    process_status_t status{};
    status.utime = utime;
    status.name = name;
    status.state = process_status_t::FINISHED;
    channel_count_t count{};
    count.channel = channel::kLaser;
    count.received = 1200;
    count.bad = 2;
    status.inputs = {count};
    status.ninputs = 1;
    status.latency_p50_us =
        utime % 977;  // differs between machines, must not be seen in the results
    log.write(utime, channel::kStatus, status);
  }
}

int match_verdict(int scan) {
  if (scan == 0) return scan_match_t::FIRST;
  if (scan % 300 > 270) return scan_match_t::DEGENERATE;
  return scan % 211 == 0 ? scan_match_t::LOW_OVERLAP : scan_match_t::OK;
}

}  // namespace

SyntheticRun write_synthetic_run(const std::string& log_path, int scans, int drop_pose_every,
                                 std::int64_t start_utime) {
  SyntheticRun run;
  run.T_base_laser = {0.2, 0, 0};
  run.T_world_map = route(0);
  const SensorInfo sensor{run.T_base_laser, 0.05, 20, false, 0};
  LogWriter log(log_path);
  write_head(log, sensor, start_utime);
  Estimator estimator(log, sensor);
  Canvas canvas;
  Pose2 T_odom_base;
  std::int64_t utime = start_utime;
  for (int i = 0; i < scans; ++i, utime += 100'000) {
    const Pose2 T_world_base = route(2 * kPi * i / 600);
    if (i > 0) {
      Pose2 motion = between(run.truth.back().pose, T_world_base);
      motion.heading += 0.0007;
      T_odom_base = T_odom_base * motion;
      if (i < 600) run.lap_m += distance(run.truth.back().pose, T_world_base);
    }
    run.truth.push_back({utime, T_world_base});
    const Scan scan = scan_building(T_world_base * run.T_base_laser, utime);
    const Pose2 T_map_true = between(run.T_world_map, T_world_base);
    log.write(utime, channel::kGroundTruth, to_message(TimedPose{utime, T_world_base}));
    log.write(utime, channel::kOdometry, to_message(TimedPose{utime, T_odom_base}));
    log.write(utime, channel::kLaser, to_message(scan));
    scan_match_t match{};
    match.utime = utime;
    match.verdict = static_cast<std::int8_t>(match_verdict(i));
    log.write(utime, channel::kScanMatch, match);
    estimator.step(scan, T_map_true,
                   !drop_pose_every || i % drop_pose_every != drop_pose_every - 1);
    if (i % 5 == 0) canvas.add(T_map_true * run.T_base_laser, scan);
  }
  estimator.settle(utime);
  for (const map_tile_t& tile : canvas.tiles(utime)) log.write(utime, channel::kMapTile, tile);
  write_semantics(log, utime, run.T_world_map.inverse());
  write_status(log, utime);
  log.close();
  run.nodes = static_cast<int>(estimator.nodes.size());
  run.loop_edges = estimator.loop_edges;
  return run;
}

}  // namespace modslam::test
