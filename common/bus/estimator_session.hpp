// SPDX-License-Identifier: BSD-3-Clause
/// @file What every estimator does on the bus: POSE for each scan, NODE when the robot has moved enough, GRAPH for what changed,
/// and the answer to SYNC_REQUEST. Estimators differ only in the measurements that they feed in.
///
/// What it says about the graph goes into its journal first; a session that finds a journal goes on where that one ends.
#pragma once
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <optional>
#include <set>

#include "common/bus/bus.hpp"
#include "common/bus/estimator_journal.hpp"
#include "common/graph/estimator.hpp"
#include "common/matching/oriented_points.hpp"
#include "common/scan/scan.hpp"

namespace modslam {

class EstimatorSession {
 public:
  enum Mode {
    kOwn,       ///< goes on with this process's journal and writes it
    kReadOnly,  ///< tells of the graph in the journal of another run's graph_optimizer, which stays as it is
  };
  EstimatorSession(Bus& bus, const EstimatorConfig& config, const JournalConfig& journal = {}, Mode mode = kOwn);

  /// Where the sources said the robot was at the newest scan: kept in the journal for whoever feeds the session. Set before step().
  estimator_state_t& tracking() { return state_; }
  const estimator_state_t& state() const { return state_; }
  /// Whether it goes on from a journal; tracking() then holds what was set in the life before.
  bool resumed() const { return resumed_; }
  /// [us] of wall time when the life before wrote its last record.
  std::int64_t resumed_from_us() const { return resumed_from_us_; }
  /// Mount of the laser at the newest node.
  std::optional<SensorInfo> sensor() const;

  /// One scan further; see GraphEstimator::move.
  void step(const Scan& scan, const SensorInfo& sensor, const std::vector<MotionMeasurement>& measurements,
            Verdict verdict);
  /// Says where the robot is in the graph as it stands.
  void place(std::int64_t utime, const Pose2& T_map_base, const Eigen::Matrix3d& information, Verdict verdict);
  LoopFate add_loop(const LoopProposal& proposal);
  /// The input has ended: optimise to convergence and publish what moved.
  void finish();
  /// How scans are compared with nodes: for places that are full of nodes, and for polish(). Without it every place gets nodes.
  struct Places {
    RangeNoise noise;
    double range_limit_m = 0;
    PlaceLimits limits;
  };
  void compare_scans(const Places& places) { places_ = places; }
  /// Measures all scans that see the same surfaces against each other and moves the nodes accordingly; publishes what moved.
  /// Needs compare_scans().
  void polish();
  /// Sends a piece of what was asked for; called often, so that answers do not flood the network.
  void tick();

  const std::vector<graph_node_t>& nodes() const { return nodes_; }
  const GraphEstimator& estimator() const { return estimator_; }
  std::string words() const;

 private:
  struct Letter {  ///< written, not sent yet
    const char* channel;
    std::vector<std::uint8_t> bytes;
  };
  template <class Message>
  void publish_later(const char* channel, const Message& message, bool into_journal);
  void write_node(const Scan& scan, const SensorInfo& sensor, NodeId id);
  void write_pose(std::int64_t utime, const GraphEstimator::Step& step, Verdict verdict);
  void write_changes();
  void write_update(const GraphChanges& changes, bool snapshot);
  /// Completes what was written with the present state in the journal, then sends it.
  void send();
  void resume();
  void write_anchor();
  GraphEstimator::Step advance(const Scan& scan, const SensorInfo& sensor, const std::vector<MotionMeasurement>& measurements, Verdict verdict);
  Localize locator(const Scan& scan, const SensorInfo& sensor) const;
  Keyframe keyframe(NodeId id, double spacing_m) const;

  Bus& bus_;
  GraphEstimator estimator_;
  Journal journal_;
  std::vector<Letter> letters_;
  std::optional<Places> places_;
  estimator_state_t state_{};
  bool resumed_ = false;
  std::int64_t resumed_from_us_ = 0;
  std::string trouble_;
  std::set<std::pair<NodeId, NodeId>> loops_seen_;
  std::vector<graph_node_t> nodes_;
  std::int32_t unrecognised_ = 0;  ///< scans since the last that was recognised, taken while the wheels stood
  std::int64_t breaks_ = 0;
  std::int64_t waiting_ = 0, refused_ = 0;
  std::int64_t size() const { return static_cast<std::int64_t>(nodes_.size()) + estimator_.accepted(); }
  std::int64_t polished_size_ = 0;  ///< nodes and loops at the last polish
  NodeId resend_from_ = -1;  ///< -1: nobody asked
};

/// Message to proposal. @throws BadMessage.
LoopProposal to_loop(const loop_closure_t& message);
loop_closure_t to_message(const LoopProposal& loop, std::int64_t utime, std::int64_t seq);

}  // namespace modslam
