// SPDX-License-Identifier: BSD-3-Clause
/// @file The pose graph as a recorded run left it.
///
/// A log cannot be asked again, so unlike GraphMirror this one goes on where messages are missing:
/// nodes and updates after a gap still count, and the gap is told.
#pragma once
#include <map>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/graph/types.hpp"
#include "common/scan/scan.hpp"

namespace modslam::report {

class GraphRecord {
 public:
  /// @return true when another session's graph begins with this node: everything known is gone.
  /// @throws BadMessage
  bool take(const graph_node_t& message);
  void take(const graph_update_t& message);

  /// Where the nodes are in the end.
  std::map<NodeId, Pose2> poses() const;
  const std::map<EdgeId, GraphEdge>& edges() const { return edges_; }
  const std::map<NodeId, std::int64_t>& node_utimes() const { return node_utimes_; }
  const SensorInfo* sensor() const { return node_utimes_.empty() ? nullptr : &sensor_; }
  std::int64_t epoch() const { return epoch_; }
  std::size_t loops_accepted() const { return loops_.size(); }
  std::size_t loops_retracted() const { return loops_retracted_.size(); }
  /// Updates and nodes that the log does not hold.
  std::int64_t missing_updates() const { return missing_updates_; }
  std::int64_t missing_nodes() const;

 private:
  void apply(const std::vector<graph_update_t>& chunks);

  std::map<NodeId, Pose2> made_at_, moved_to_;
  std::map<NodeId, std::int64_t> node_utimes_;
  std::map<EdgeId, GraphEdge> edges_;
  std::set<EdgeId> loops_;  ///< every loop edge that ever was
  std::set<EdgeId> loops_retracted_;
  std::map<int, graph_update_t> chunks_;  ///< of the update that is coming in
  SensorInfo sensor_;
  std::int64_t seq_ = 0, epoch_ = 0, announced_nodes_ = 0, missing_updates_ = 0;
};

}  // namespace modslam::report
