// SPDX-License-Identifier: BSD-3-Clause
/// @file A consumer's copy of the pose graph, kept complete from NODE and GRAPH whatever got lost on the way.
///
/// Both streams are numbered. A gap, a late start or a restart makes the mirror ask with SYNC_REQUEST (again
/// every half second of message time until it is whole); the estimator answers with the missing NODEs and a GRAPH snapshot.
#pragma once
#include <functional>
#include <map>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <optional>
#include <set>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/graph/types.hpp"
#include "common/scan/scan.hpp"

namespace modslam {

/// @throws BadMessage on impossible nodes or values that are not finite.
GraphEdge to_edge(const graph_edge_t& message);

struct MirrorNode {
  NodeId id = 0;
  std::int64_t utime = 0;
  Pose2 T_map_base;  ///< where it is now
  SensorInfo sensor;
  Scan scan;
};

class GraphMirror {
 public:
  enum Scans { kKeepScans, kDropScans };  ///< dropped ones are still seen in on_node

  /// Subscribes to NODE, GRAPH and POSE and asks for what was published before.
  explicit GraphMirror(Bus& bus, Scans scans = kKeepScans);

  /// Called in order of id, once for each node, as soon as all before it are there.
  std::function<void(const MirrorNode&)> on_node;
  /// Called after an update was applied, with the nodes whose pose it changed (known ones only).
  std::function<void(const std::vector<NodeId>& moved)> on_update;
  /// Called with each POSE, which the mirror reads anyway: subscribing twice would count twice.
  std::function<void(const pose_estimate_t&)> on_pose;
  /// Called when another session's graph begins: everything known is gone.
  std::function<void()> on_reset;

  const std::vector<MirrorNode>& nodes() const { return nodes_; }
  /// In force, in order of id.
  const std::vector<GraphEdge>& edges() const { return edges_; }
  std::int64_t epoch() const { return epoch_; }
  /// Nothing is known to be missing.
  bool complete() const;
  /// complete(), and somebody has told what there is (or nobody answered for a while).
  bool settled() const { return complete() && (heard_ || unanswered_ > 2); }
  /// With a steady clock, often: asks again while something is missing, also when nobody says anything more.
  void tick(std::int64_t steady_us);
  /// Something on NODE or GRAPH was lost that no later message told of.
  void suspect() { suspicious_ = true; }

 private:
  void take_node(const graph_node_t& message);
  void take_update(const graph_update_t& message);
  void take_pose(const pose_estimate_t& message);
  void apply(const std::vector<graph_update_t>& chunks);
  void set_pose(NodeId id, const Pose2& T_map_base, std::vector<NodeId>& moved);
  void append_ready_nodes();
  void request(bool urgent);
  void reset();

  Bus& bus_;
  Scans scans_;
  std::vector<MirrorNode> nodes_;
  std::map<NodeId, MirrorNode> early_nodes_;       ///< arrived before one of their forerunners
  std::map<NodeId, Pose2> early_poses_;            ///< newest pose of nodes that are not here yet
  std::vector<GraphEdge> edges_;
  std::map<std::pair<std::int64_t, bool>, std::map<int, graph_update_t>> chunks_;  ///< by (seq, snapshot)
  std::int64_t seq_ = 0, newest_seq_ = 0, epoch_ = 0;
  NodeId announced_nodes_ = 0;
  NodeId counted_nodes_ = 0;  ///< gaps below this one are in the status already
  std::int64_t last_request_utime_ = 0, last_request_us_ = 0;
  bool heard_ = false, suspicious_ = false;
  int unanswered_ = 0;
};

}  // namespace modslam
