// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/graph_mirror.hpp"

#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"

namespace modslam {
namespace {

constexpr std::int64_t kRequestEvery_us = 500'000;
constexpr std::int64_t kAskAgainEvery_us = 300'000, kAskSeldom_us = 2'000'000;  // of wall time; nobody answers: seldom
constexpr int kPatience = 3;
constexpr NodeId kMaxNodes = 10'000'000;

void check_node(NodeId id) {
  if (id < 0 || id > kMaxNodes) throw BadMessage("node id " + std::to_string(id));
}

/// Refuses the whole message before any part of it is taken in.
void check(const graph_update_t& message) {
  if (message.nchunks < 1 || message.nchunks > 100000 || message.chunk < 0 || message.chunk >= message.nchunks)
    throw BadMessage("chunk " + std::to_string(message.chunk) + " of " + std::to_string(message.nchunks));
  if (message.nnodes < 0 || message.nnodes > kMaxNodes) throw BadMessage("impossible number of nodes");
  for (const graph_edge_t& edge : message.edges) to_edge(edge);
  for (const node_pose_t& pose : message.poses) {
    check_node(pose.id);
    to_pose(pose.T_map_base);
  }
}

}  // namespace

GraphEdge to_edge(const graph_edge_t& message) {
  check_node(message.from_node);
  check_node(message.to_node);
  if (message.from_node == message.to_node) throw BadMessage("an edge from node " + std::to_string(message.to_node) + " to itself");
  GraphEdge edge;
  edge.id = message.id;
  edge.from = message.from_node;
  edge.to = message.to_node;
  edge.kind = message.kind == graph_edge_t::LOOP ? EdgeKind::kLoop : EdgeKind::kSequence;
  edge.T_from_to = to_pose(message.T_from_to);
  edge.information = to_symmetric(message.information);
  return edge;
}

namespace {

std::vector<GraphEdge>::iterator place_of(std::vector<GraphEdge>& edges, EdgeId id) {
  return std::lower_bound(edges.begin(), edges.end(), id, [](const GraphEdge& edge, EdgeId wanted) { return edge.id < wanted; });
}

void put(std::vector<GraphEdge>& edges, const GraphEdge& edge) {
  const auto at = place_of(edges, edge.id);
  if (at != edges.end() && at->id == edge.id) *at = edge;
  else edges.insert(at, edge);  // nearly always at the end
}

void take(std::vector<GraphEdge>& edges, EdgeId id) {
  const auto at = place_of(edges, id);
  if (at != edges.end() && at->id == id) edges.erase(at);
}

}  // namespace

GraphMirror::GraphMirror(Bus& bus, Scans scans) : bus_(bus), scans_(scans) {
  bus.subscribe<graph_node_t>(channel::kNode, [this](const graph_node_t& m) { take_node(m); });
  bus.subscribe<graph_update_t>(channel::kGraph, [this](const graph_update_t& m) { take_update(m); });
  bus.subscribe<pose_estimate_t>(channel::kPose, [this](const pose_estimate_t& m) { take_pose(m); });
  request(true);
}

bool GraphMirror::complete() const {
  return early_nodes_.empty() && announced_nodes_ <= static_cast<NodeId>(nodes_.size()) && seq_ >= newest_seq_;
}

void GraphMirror::tick(std::int64_t steady_us) {
  if (steady_us - last_request_us_ < (unanswered_ < kPatience ? kAskAgainEvery_us : kAskSeldom_us)) return;
  if (heard_ && complete() && !suspicious_) return;
  last_request_us_ = steady_us;
  unanswered_ += !heard_;
  request(true);
}

void GraphMirror::take_node(const graph_node_t& message) {
  check_node(message.id);
  MirrorNode node{message.id, message.utime, to_pose(message.T_map_base), to_sensor_info(message.sensor),
                  to_scan(message.scan)};
  bus_.saw_utime(message.utime);
  if (node.id == 0 && !nodes_.empty() && nodes_[0].utime != node.utime) reset();
  if (node.id < static_cast<NodeId>(nodes_.size())) return;  // an answer to somebody else
  announced_nodes_ = std::max(announced_nodes_, node.id + 1);
  early_nodes_.emplace(node.id, std::move(node));
  append_ready_nodes();
  if (!complete()) request(false);
}

void GraphMirror::append_ready_nodes() {
  while (!early_nodes_.empty() && early_nodes_.begin()->first == static_cast<NodeId>(nodes_.size())) {
    nodes_.push_back(std::move(early_nodes_.begin()->second));
    early_nodes_.erase(early_nodes_.begin());
    const auto pose = early_poses_.find(nodes_.back().id);
    if (pose != early_poses_.end()) {
      nodes_.back().T_map_base = pose->second;
      early_poses_.erase(pose);
    }
    if (on_node) on_node(nodes_.back());
    if (scans_ == kDropScans) nodes_.back().scan = Scan();
  }
}

void GraphMirror::take_update(const graph_update_t& message) {
  check(message);
  bus_.saw_utime(message.utime);
  heard_ = true;
  if (message.snapshot) suspicious_ = false;
  newest_seq_ = std::max(newest_seq_, message.seq);
  announced_nodes_ = std::max(announced_nodes_, message.nnodes);
  // A snapshot of what is already here repairs nobody: skip it. An old update is an echo.
  if (message.seq <= seq_ && !(message.snapshot && message.seq == seq_ && !complete())) return;

  auto& parts = chunks_[{message.seq, message.snapshot != 0}];
  parts.emplace(message.chunk, message);
  if (static_cast<int>(parts.size()) == message.nchunks && (message.snapshot || message.seq == seq_ + 1)) {
    std::vector<graph_update_t> whole;
    for (auto& [chunk, part] : parts) whole.push_back(std::move(part));
    apply(whole);
  }
  if (!complete()) request(false);
}

void GraphMirror::apply(const std::vector<graph_update_t>& chunks) {
  const bool snapshot = chunks[0].snapshot != 0;
  std::vector<NodeId> moved;
  if (snapshot) edges_.clear();
  for (const graph_update_t& chunk : chunks) {
    for (const graph_edge_t& edge : chunk.edges) put(edges_, to_edge(edge));
    for (const EdgeId id : chunk.retracted) take(edges_, id);
    for (const node_pose_t& pose : chunk.poses) set_pose(pose.id, to_pose(pose.T_map_base), moved);
  }
  if (seq_ != 0 && chunks[0].seq > seq_ + 1) bus_.count_gap(channel::kGraph, chunks[0].seq - seq_ - 1);
  seq_ = chunks[0].seq;
  epoch_ = chunks[0].epoch;
  while (!chunks_.empty() && chunks_.begin()->first.first <= seq_) chunks_.erase(chunks_.begin());
  if (on_update) on_update(moved);
  // What waited for this one may be whole already.
  const auto next = chunks_.find({seq_ + 1, false});
  if (next != chunks_.end() && static_cast<int>(next->second.size()) == next->second.begin()->second.nchunks) {
    std::vector<graph_update_t> whole;
    for (auto& [chunk, part] : next->second) whole.push_back(std::move(part));
    apply(whole);
  }
}

void GraphMirror::set_pose(NodeId id, const Pose2& T_map_base, std::vector<NodeId>& moved) {
  if (id >= static_cast<NodeId>(nodes_.size())) {
    early_poses_[id] = T_map_base;
    return;
  }
  nodes_[static_cast<std::size_t>(id)].T_map_base = T_map_base;
  moved.push_back(id);
}

void GraphMirror::take_pose(const pose_estimate_t& message) {
  bus_.saw_utime(message.utime);
  announced_nodes_ = std::max(announced_nodes_, std::min(message.node_id + 1, kMaxNodes));
  if (!complete()) request(false);
  if (on_pose) on_pose(message);
}

void GraphMirror::request(bool urgent) {
  if (!urgent && bus_.utime() - last_request_utime_ < kRequestEvery_us) return;
  last_request_utime_ = bus_.utime();
  // Each missing node counts once, however often it is asked for.
  const NodeId first = std::max(static_cast<NodeId>(nodes_.size()), counted_nodes_);
  const NodeId end = early_nodes_.empty() ? announced_nodes_ : early_nodes_.begin()->first;
  if (end > first) {
    bus_.count_gap(channel::kNode, end - first);
    counted_nodes_ = end;
  }
  sync_request_t message{};
  message.utime = bus_.utime();
  message.requester = bus_.name();
  message.from_node = static_cast<std::int64_t>(nodes_.size());
  message.from_seq = seq_ + 1;
  bus_.publish(channel::kSyncRequest, message);
}

void GraphMirror::reset() {
  nodes_.clear();
  early_nodes_.clear();
  early_poses_.clear();
  edges_.clear();
  chunks_.clear();
  seq_ = newest_seq_ = epoch_ = announced_nodes_ = counted_nodes_ = 0;
  if (on_reset) on_reset();
}

}  // namespace modslam
