// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/estimator_session.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <modslam/estimator_anchor_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/loops/overlap.hpp"

namespace modslam {
namespace {

constexpr std::size_t kPosesPerChunk = 1000, kEdgesPerChunk = 400;  // both below 60 kB
constexpr double kPolishSpacing_m = 0.05, kPlaceSpacing_m = 0.04;
constexpr double kNothingNew = 0.75;       // share of a scan that lies on what the nodes around saw
constexpr std::int32_t kUnrecognisedScans = 8;  // as kFailuresBeforeRestart of the scan matcher
constexpr std::ptrdiff_t kEnoughReturns = 40;   // fewer: the laser is covered, and the wheels still tell the way
constexpr double kStands_mps = 0.05, kStands_radps = 0.1, kStands_m = 0.002, kStands_rad = 0.002;

/// Whether the wheels hardly turned in `dt_s`.
bool stands(const std::vector<MotionMeasurement>& measurements, double dt_s) {
  if (measurements.empty() || dt_s <= 0) return false;
  const Pose2 motion = fuse(measurements).T_from_to;
  return std::hypot(motion.x, motion.y) < kStands_m + kStands_mps * dt_s && std::abs(motion.heading) < kStands_rad + kStands_radps * dt_s;
}
constexpr std::size_t kPlaceNodes = 12;  // that a scan in known space is matched against: the nearest
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

EstimatorSession::EstimatorSession(Bus& bus, const EstimatorConfig& config, const JournalConfig& journal, Mode mode)
    : bus_(bus), estimator_(config), journal_(journal, mode == kOwn ? bus.name() : "graph_optimizer", mode == kOwn ? Journal::kAppend : Journal::kReadOnly) {
  resume();
  bus.publishes(channel::kPose);
  bus.subscribe<sync_request_t>(channel::kSyncRequest, [this](const sync_request_t& m) {
    if (m.from_node < 0) throw BadMessage("from_node " + std::to_string(m.from_node));
    if (nodes_.empty() || m.requester == bus_.name()) return;
    resend_from_ = resend_from_ < 0 ? m.from_node : std::min(resend_from_, m.from_node);
  });
}

void EstimatorSession::resume() {
  std::optional<EstimatorPast> past = read_estimator_journal(journal_, trouble_);
  resumed_from_us_ = journal_.last_us();
  if (!trouble_.empty()) trouble_ = "; its journal cannot be used: " + trouble_;
  if (!past) return;
  resumed_ = true;
  state_ = past->state;
  unrecognised_ = past->unrecognised;
  nodes_ = std::move(past->nodes);
  estimator_.resume(std::move(past->memory));
  for (const LoopProposal& loop : past->loops) loops_seen_.emplace(loop.from, loop.to);
  bus_.saw_utime(state_.utime);
}

std::optional<SensorInfo> EstimatorSession::sensor() const {
  if (nodes_.empty()) return std::nullopt;
  return to_sensor_info(nodes_.back().sensor);
}

void EstimatorSession::step(const Scan& scan, const SensorInfo& sensor,
                            const std::vector<MotionMeasurement>& measurements, Verdict verdict) {
  GraphEstimator::Step step = advance(scan, sensor, measurements, verdict);
  bus_.saw_utime(scan.utime);
  state_.utime = scan.utime;
  put(state_.T_node_base, step.T_node_base);
  put(state_.covariance, step.covariance);
  if (estimator_.part_of_robot() != 0) {  // in that part it is sure; where the part lies nobody knows
    verdict = Verdict::kAmbiguous;
    step.covariance += Eigen::Vector3d(1e4, 1e4, 10).asDiagonal();
  }
  if (step.is_new_node) write_node(scan, sensor, step.node);
  write_changes();
  write_pose(scan.utime, step, verdict);
  send();
}

/// After as many scans that were not recognised while the wheels stood as make the matcher begin anew, the robot may be anywhere: somebody carried it.
GraphEstimator::Step EstimatorSession::advance(const Scan& scan, const SensorInfo& sensor, const std::vector<MotionMeasurement>& measurements,
                                               Verdict verdict) {
  if (!places_) return estimator_.move(measurements);
  const bool is_known = is_usable(verdict) || verdict == Verdict::kFirst;
  const bool was_lost = is_known && unrecognised_ >= kUnrecognisedScans;
  const auto returns = std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(), [&](float r) { return is_return(r, sensor); });
  if (is_known) unrecognised_ = 0;
  else unrecognised_ += returns >= kEnoughReturns && stands(measurements, 1e-6 * static_cast<double>(scan.utime - state_.utime));
  if (!was_lost) return estimator_.move(measurements, locator(scan, sensor), unrecognised_ == 0);
  ++breaks_;
  return estimator_.begin_apart();
}

/// Answers where a scan was taken among old nodes.
Localize EstimatorSession::locator(const Scan& scan, const SensorInfo& sensor) const {
  return [&](const std::vector<NodeId>& known, const Anchorage& expected) {
    const Pose2& T_map_node = estimator_.graph().poses[static_cast<std::size_t>(known.front())];
    const Keyframe now{T_map_node * expected.T_node_base, orient(scan, sensor, places_->noise, places_->range_limit_m, kPlaceSpacing_m),
                       sensor.T_base_laser.translation()};
    std::vector<Keyframe> nodes;
    for (std::size_t k = 0; k < std::min(known.size(), kPlaceNodes); ++k) nodes.push_back(keyframe(known[k], kPlaceSpacing_m));
    std::vector<const Keyframe*> all;
    for (const Keyframe& node : nodes) all.push_back(&node);
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R.topLeftCorner<2, 2>() = rotation(-expected.T_node_base.heading);
    const PlaceMatch match = match_place(now, all, R * expected.covariance * R.transpose(), places_->limits);
    Localized answer;
    answer.shows_nothing_new = match.figures.overlap > kNothingNew && match.verdict != Verdict::kInconsistent;
    // A fix that is blind along a corridor would cut the way there in pieces; one at its end corrects all of it.
    if (match.verdict == Verdict::kOk) answer.fix = AnchorFix{between(T_map_node, match.T_map_base), match.information};
    return answer;
  };
}

/// A node and its scan, oriented anew.
Keyframe EstimatorSession::keyframe(NodeId id, double spacing_m) const {
  const graph_node_t& node = nodes_[static_cast<std::size_t>(id)];
  const SensorInfo sensor = to_sensor_info(node.sensor);
  return {estimator_.graph().poses[static_cast<std::size_t>(id)], orient(to_scan(node.scan), sensor, places_->noise, places_->range_limit_m, spacing_m),
          sensor.T_base_laser.translation()};
}

void EstimatorSession::place(std::int64_t utime, const Pose2& T_map_base, const Eigen::Matrix3d& information, Verdict verdict) {
  const std::vector<Pose2>& poses = estimator_.graph().poses;
  const auto nearest = std::min_element(poses.begin(), poses.end(), [&](const Pose2& a, const Pose2& b) {
    return distance(a, T_map_base) < distance(b, T_map_base);
  });
  bus_.saw_utime(utime);
  GraphEstimator::Step step;
  step.T_map_base = T_map_base;
  step.node = static_cast<NodeId>(nearest - poses.begin());
  step.T_node_base = between(*nearest, T_map_base);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(-nearest->heading);
  step.covariance = R * (information + 1e-3 * Eigen::Matrix3d::Identity()).inverse() * R.transpose();
  write_pose(utime, step, verdict);
  send();
}

LoopFate EstimatorSession::add_loop(const LoopProposal& proposal) {
  // One that is said twice (its detector was restarted) must not confirm itself.
  if (!loops_seen_.emplace(proposal.from, proposal.to).second) return LoopFate::kRefused;
  const LoopFate fate = estimator_.add_loop(proposal);
  waiting_ += fate == LoopFate::kWaiting;
  refused_ += fate == LoopFate::kRefused;
  journal_.write(kLoopRecord, modslam::to_message(proposal, state_.utime, 0));
  write_changes();
  send();
  return fate;
}

template <class Message>
void EstimatorSession::publish_later(const char* channel, const Message& message, bool into_journal) {
  Letter letter{channel, std::vector<std::uint8_t>(static_cast<std::size_t>(message.getEncodedSize()))};
  const int size = static_cast<int>(letter.bytes.size());
  if (message.encode(letter.bytes.data(), 0, size) != size) throw std::logic_error(std::string("cannot encode a message for ") + channel);
  if (into_journal) journal_.write(channel, letter.bytes.data(), size);
  letters_.push_back(std::move(letter));
}

void EstimatorSession::send() {
  state_.nnodes = static_cast<std::int64_t>(nodes_.size());
  state_.epoch = estimator_.epoch();
  state_.postponed = estimator_.postponed();
  write_anchor();
  journal_.write(kEstimatorState, state_);
  for (const Letter& letter : letters_) bus_.publish_bytes(letter.channel, letter.bytes.data(), static_cast<int>(letter.bytes.size()));
  letters_.clear();
}

void EstimatorSession::write_anchor() {
  estimator_anchor_t anchor{};
  anchor.node = estimator_.robot().node;
  anchor.unrecognised = unrecognised_;
  put(anchor.T_step_base, estimator_.T_step_base());
  journal_.write(kEstimatorAnchor, anchor);
}

void EstimatorSession::finish() {
  if (nodes_.empty() || size() == polished_size_) return;  // what was polished is not settled back
  estimator_.settle(true);
  write_changes();
  send();
}

void EstimatorSession::polish() {
  if (size() == polished_size_) return;  // nothing came since
  std::vector<Keyframe> nodes;
  for (std::size_t k = 0; k < nodes_.size(); ++k) nodes.push_back(keyframe(static_cast<NodeId>(k), kPolishSpacing_m));
  estimator_.polish(measure_overlaps(std::move(nodes)));
  polished_size_ = size();
  write_changes();
  send();
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
  write_update(all, true);
  send();
}

void EstimatorSession::write_node(const Scan& scan, const SensorInfo& sensor, NodeId id) {
  graph_node_t message{};
  message.utime = scan.utime;
  message.id = id;
  put(message.T_map_base, estimator_.graph().poses[static_cast<std::size_t>(id)]);
  message.sensor = to_message(sensor, scan.utime);
  message.scan = to_message(scan);
  nodes_.push_back(message);
  publish_later(channel::kNode, message, true);
}

void EstimatorSession::write_pose(std::int64_t utime, const GraphEstimator::Step& step, Verdict verdict) {
  pose_estimate_t message{};
  message.utime = utime;
  message.seq = state_.pose_seq++;
  message.epoch = estimator_.epoch();
  put(message.T_map_base, step.T_map_base);
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation(estimator_.graph().poses[static_cast<std::size_t>(step.node)].heading);
  put(message.covariance, R * step.covariance * R.transpose());
  message.verdict = static_cast<std::int8_t>(verdict);
  message.node_id = step.node;
  put(message.T_node_base, step.T_node_base);
  message.node_before = step.node_before;
  put(message.T_before_base, step.T_before_base);
  publish_later(channel::kPose, message, false);
}

void EstimatorSession::write_changes() {
  const GraphChanges changes = estimator_.take_changes();
  if (changes.empty()) return;
  ++state_.graph_seq;
  write_update(changes, false);
}

void EstimatorSession::write_update(const GraphChanges& changes, bool snapshot) {
  const std::size_t chunks = std::max<std::size_t>(
      {1, (changes.added.size() + kEdgesPerChunk - 1) / kEdgesPerChunk, (changes.moved.size() + kPosesPerChunk - 1) / kPosesPerChunk});
  for (std::size_t k = 0; k < chunks; ++k) {
    graph_update_t message{};
    message.utime = nodes_.back().utime;
    message.seq = state_.graph_seq;
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
    publish_later(channel::kGraph, message, !snapshot);
  }
}

std::string EstimatorSession::words() const {
  return std::to_string(state_.pose_seq) + " poses, " + std::to_string(nodes_.size()) + " nodes, " +
         (estimator_.reused() ? std::to_string(estimator_.reused()) + " times on old ones, " : "") +
         std::to_string(estimator_.accepted()) + " loops accepted, " + std::to_string(refused_) + " refused, " +
         std::to_string(estimator_.retracted()) + " retracted" + (breaks_ ? ", carried away " + std::to_string(breaks_) + " times" : "") +
         (estimator_.part_of_robot() ? ", lost: apart from the map since node " + std::to_string(estimator_.part_of_robot()) : "") + trouble_ +
         (journal_.trouble().empty() ? "" : "; " + journal_.trouble());
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
