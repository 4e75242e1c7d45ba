// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/graph_record.hpp"

#include "common/bus/bus.hpp"
#include "common/bus/conversions.hpp"

namespace modslam::report {
namespace {

constexpr NodeId kMaxNodes = 10'000'000;

void check_id(NodeId id) {
  if (id < 0 || id > kMaxNodes) throw BadMessage("node id " + std::to_string(id));
}

GraphEdge to_edge(const graph_edge_t& message) {
  check_id(message.from_node);
  check_id(message.to_node);
  return {message.id,
          message.from_node,
          message.to_node,
          message.kind == graph_edge_t::LOOP ? EdgeKind::kLoop : EdgeKind::kSequence,
          to_pose(message.T_from_to),
          to_symmetric(message.information)};
}

}  // namespace

bool GraphRecord::take(const graph_node_t& message) {
  check_id(message.id);
  const Pose2 T_map_base = to_pose(message.T_map_base);
  const SensorInfo sensor = to_sensor_info(message.sensor);
  const auto first = node_utimes_.find(0);
  const bool new_session =
      message.id == 0 && first != node_utimes_.end() && first->second != message.utime;
  if (new_session) *this = GraphRecord();
  if (node_utimes_.count(message.id)) return false;  // the answer to a SYNC_REQUEST
  made_at_[message.id] = T_map_base;
  node_utimes_[message.id] = message.utime;
  sensor_ = sensor;
  return new_session;
}

void GraphRecord::take(const graph_update_t& message) {
  if (message.nchunks < 1 || message.nchunks > 100000 || message.chunk < 0 ||
      message.chunk >= message.nchunks)
    throw BadMessage("chunk " + std::to_string(message.chunk) + " of " +
                     std::to_string(message.nchunks));
  check_id(message.nnodes);
  const bool repairs = message.snapshot && message.seq == seq_ && missing_updates_ > 0;
  if (message.seq <= seq_ && !repairs) return;  // the answer to a SYNC_REQUEST
  if (!chunks_.empty() && (chunks_.begin()->second.seq != message.seq ||
                           chunks_.begin()->second.snapshot != message.snapshot))
    chunks_.clear();
  chunks_[message.chunk] = message;
  if (static_cast<int>(chunks_.size()) < message.nchunks) return;
  std::vector<graph_update_t> whole;
  for (auto& [chunk, part] : chunks_) whole.push_back(std::move(part));
  chunks_.clear();
  apply(whole);
}

void GraphRecord::apply(const std::vector<graph_update_t>& chunks) {
  const graph_update_t& head = chunks[0];
  if (head.snapshot) {
    edges_.clear();
    missing_updates_ = 0;
  } else {
    missing_updates_ += head.seq - seq_ - 1;
  }
  seq_ = head.seq;
  epoch_ = head.epoch;
  announced_nodes_ = head.nnodes;
  for (const graph_update_t& chunk : chunks) {
    for (const graph_edge_t& message : chunk.edges) {
      const GraphEdge edge = to_edge(message);
      edges_[edge.id] = edge;
      if (edge.kind == EdgeKind::kLoop) loops_.insert(edge.id);
    }
    for (const EdgeId id : chunk.retracted) {
      edges_.erase(id);
      if (loops_.count(id)) loops_retracted_.insert(id);
    }
    for (const node_pose_t& pose : chunk.poses) {
      check_id(pose.id);
      moved_to_[pose.id] = to_pose(pose.T_map_base);
    }
  }
}

std::map<NodeId, Pose2> GraphRecord::poses() const {
  std::map<NodeId, Pose2> poses = moved_to_;
  poses.insert(made_at_.begin(), made_at_.end());
  return poses;
}

std::int64_t GraphRecord::missing_nodes() const {
  const std::int64_t last = node_utimes_.empty() ? 0 : node_utimes_.rbegin()->first + 1;
  return std::max(announced_nodes_, last) - static_cast<std::int64_t>(node_utimes_.size());
}

}  // namespace modslam::report
