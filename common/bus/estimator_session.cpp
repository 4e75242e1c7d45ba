// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/estimator_session.hpp"

#include <algorithm>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/loops/overlap.hpp"

namespace modslam {
namespace {

constexpr std::size_t kPosesPerChunk = 1000, kEdgesPerChunk = 400;  // both below 60 kB
constexpr double kPolishSpacing_m = 0.05;
constexpr NodeId kNodesPerTick = 20;

graph_edge_t to_message(const GraphEdge& edge) {
  graph_edge_t message{};
  message.id = edge.id;
  message.from_node = edge.from;
  message.to_node = edge.to;
  message.kind = static_cast<std::int8_t>(edge.kind);
  put(message.T_from_to, edge.T_from_to);
  put(message.information, edge.information);
  return message;
}

/// The part of `list` that belongs into chunk k.
template <class T>
std::pair<std::size_t, std::size_t> part(const std::vector<T>& list, std::size_t per_chunk, std::size_t k) {
  return {std::min(list.size(), k * per_chunk), std::min(list.size(), (k + 1) * per_chunk)};
}

}  // namespace

EstimatorSession::EstimatorSession(Bus& bus, const EstimatorConfig& config) : bus_(bus), estimator_(config) {
  bus.subscribe<sync_request_t>(channel::kSyncRequest, [this](const sync_request_t& m) {
    if (m.from_node < 0) throw BadMessage("from_node " + std::to_string(m.from_node));
    if (nodes_.empty()) return;
    resend_from_ = resend_from_ < 0 ? m.from_node : std::min(resend_from_, m.from_node);
  });
}

void EstimatorSession::step(const Scan& scan, const SensorInfo& sensor,
                            const std::vector<MotionMeasurement>& measurements, Verdict verdict) {
  const GraphEstimator::Step step = estimator_.move(measurements);
  bus_.saw_utime(scan.utime);
  if (step.is_new_node) publish_node(scan, sensor, step.node);
  publish_changes();
  publish_pose(scan, step, verdict);
}

LoopFate EstimatorSession::add_loop(const LoopProposal& proposal) {
  const LoopFate fate = estimator_.add_loop(proposal);
  waiting_ += fate == LoopFate::kWaiting;
  refused_ += fate == LoopFate::kRefused;
  publish_changes();
  return fate;
}

void EstimatorSession::finish() {
  if (nodes_.empty()) return;
  estimator_.settle(true);
  publish_changes();
}

void EstimatorSession::polish(const RangeNoise& noise, double range_limit_m) {
  const std::int64_t size = static_cast<std::int64_t>(nodes_.size()) + estimator_.accepted();
  if (size == polished_size_) return;  // nothing came since
  std::vector<Keyframe> nodes;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const SensorInfo sensor = to_sensor_info(nodes_[k].sensor);
    nodes.push_back({estimator_.graph().poses[k], orient(to_scan(nodes_[k].scan), sensor, noise, range_limit_m, kPolishSpacing_m),
                     sensor.T_base_laser.translation()});
  }
  estimator_.polish(measure_overlaps(std::move(nodes)));
  polished_size_ = size;
  publish_changes();
}

void EstimatorSession::tick() {
  if (resend_from_ < 0) return;
  const NodeId end = std::min(resend_from_ + kNodesPerTick, static_cast<NodeId>(nodes_.size()));
  for (; resend_from_ < end; ++resend_from_)
    bus_.publish(channel::kNode, nodes_[static_cast<std::size_t>(resend_from_)]);
  if (resend_from_ < static_cast<NodeId>(nodes_.size())) return;
  resend_from_ = -1;
  GraphChanges all;
  all.added = estimator_.graph().edges;
  for (std::size_t k = 0; k < nodes_.size(); ++k) all.moved.push_back(static_cast<NodeId>(k));
  publish_update(all, true);
}

void EstimatorSession::publish_node(const Scan& scan, const SensorInfo& sensor, NodeId id) {
  graph_node_t message{};
  message.utime = scan.utime;
  message.id = id;
  put(message.T_map_base, estimator_.graph().poses[static_cast<std::size_t>(id)]);
  message.sensor = to_message(sensor, scan.utime);
  message.scan = to_message(scan);
  nodes_.push_back(message);
  bus_.publish(channel::kNode, message);
}

void EstimatorSession::publish_pose(const Scan& scan, const GraphEstimator::Step& step, Verdict verdict) {
  pose_estimate_t message{};
  message.utime = scan.utime;
  message.seq = pose_seq_++;
  message.epoch = estimator_.epoch();
  put(message.T_map_base, step.T_map_base);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(estimator_.graph().poses[static_cast<std::size_t>(step.node)].heading);
  put(message.covariance, R * step.covariance * R.transpose());
  message.verdict = static_cast<std::int8_t>(verdict);
  message.node_id = step.node;
  put(message.T_node_base, step.T_node_base);
  bus_.publish(channel::kPose, message);
}

void EstimatorSession::publish_changes() {
  const GraphChanges changes = estimator_.take_changes();
  if (changes.empty()) return;
  ++graph_seq_;
  publish_update(changes, false);
}

void EstimatorSession::publish_update(const GraphChanges& changes, bool snapshot) {
  const std::size_t chunks = std::max<std::size_t>(
      {1, (changes.added.size() + kEdgesPerChunk - 1) / kEdgesPerChunk, (changes.moved.size() + kPosesPerChunk - 1) / kPosesPerChunk});
  for (std::size_t k = 0; k < chunks; ++k) {
    graph_update_t message{};
    message.utime = nodes_.back().utime;
    message.seq = graph_seq_;
    message.epoch = estimator_.epoch();
    message.snapshot = snapshot;
    message.chunk = static_cast<std::int32_t>(k);
    message.nchunks = static_cast<std::int32_t>(chunks);
    message.nnodes = static_cast<std::int64_t>(nodes_.size());
    const auto [first_edge, last_edge] = part(changes.added, kEdgesPerChunk, k);
    for (std::size_t i = first_edge; i < last_edge; ++i) message.edges.push_back(to_message(changes.added[i]));
    if (k == 0) message.retracted = changes.retracted;
    const auto [first_pose, last_pose] = part(changes.moved, kPosesPerChunk, k);
    for (std::size_t i = first_pose; i < last_pose; ++i) {
      node_pose_t pose{};
      pose.id = changes.moved[i];
      put(pose.T_map_base, estimator_.graph().poses[static_cast<std::size_t>(pose.id)]);
      message.poses.push_back(pose);
    }
    message.nedges = static_cast<std::int32_t>(message.edges.size());
    message.nretracted = static_cast<std::int32_t>(message.retracted.size());
    message.nposes = static_cast<std::int32_t>(message.poses.size());
    bus_.publish(channel::kGraph, message);
  }
}

std::string EstimatorSession::words() const {
  return std::to_string(pose_seq_) + " poses, " + std::to_string(nodes_.size()) + " nodes, " +
         std::to_string(estimator_.accepted()) + " loops accepted, " + std::to_string(refused_) + " refused, " +
         std::to_string(estimator_.retracted()) + " retracted";
}

LoopProposal to_loop(const loop_closure_t& message) {
  LoopProposal loop;
  loop.from = message.from_node;
  loop.to = message.to_node;
  loop.T_from_to = to_pose(message.T_from_to);
  loop.information = to_symmetric(message.information);
  loop.verdict = static_cast<Verdict>(message.verdict);
  loop.figures.score = message.score;
  loop.figures.overlap = message.overlap;
  loop.figures.chi2 = message.chi2;
  loop.figures.ambiguity = message.ambiguity;
  loop.figures.free_violation = message.free_violation;
  loop.figures.innovation = message.innovation;
  loop.affected = message.affected;
  return loop;
}

loop_closure_t to_message(const LoopProposal& loop, std::int64_t utime, std::int64_t seq) {
  loop_closure_t message{};
  message.utime = utime;
  message.seq = seq;
  message.from_node = loop.from;
  message.to_node = loop.to;
  put(message.T_from_to, loop.T_from_to);
  put(message.information, loop.information);
  message.verdict = static_cast<std::int8_t>(loop.verdict);
  message.score = loop.figures.score;
  message.overlap = loop.figures.overlap;
  message.chi2 = loop.figures.chi2;
  message.ambiguity = loop.figures.ambiguity;
  message.free_violation = loop.figures.free_violation;
  message.innovation = loop.figures.innovation;
  message.affected = loop.affected;
  message.naffected = static_cast<std::int32_t>(loop.affected.size());
  return message;
}

}  // namespace modslam
