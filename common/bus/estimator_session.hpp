// SPDX-License-Identifier: BSD-3-Clause
/// @file What every estimator does on the bus: POSE for each scan, NODE when the robot has moved enough, GRAPH for what changed,
/// and the answer to SYNC_REQUEST. Estimators differ only in the measurements that they feed in.
#pragma once
#include <deque>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>

#include "common/bus/bus.hpp"
#include "common/graph/estimator.hpp"
#include "common/matching/oriented_points.hpp"
#include "common/scan/scan.hpp"

namespace modslam {

class EstimatorSession {
 public:
  EstimatorSession(Bus& bus, const EstimatorConfig& config);

  /// One scan further; see GraphEstimator::move.
  void step(const Scan& scan, const SensorInfo& sensor, const std::vector<MotionMeasurement>& measurements,
            Verdict verdict);
  LoopFate add_loop(const LoopProposal& proposal);
  /// The input has ended: optimise to convergence and publish what moved.
  void finish();
  /// Measures all scans that see the same surfaces against each other and moves the nodes accordingly; publishes what moved.
  void polish(const RangeNoise& noise, double range_limit_m);
  /// Sends a piece of what was asked for; called often, so that answers do not flood the network.
  void tick();

  const GraphEstimator& estimator() const { return estimator_; }
  std::string words() const;

 private:
  void publish_node(const Scan& scan, const SensorInfo& sensor, NodeId id);
  void publish_pose(const Scan& scan, const GraphEstimator::Step& step, Verdict verdict);
  void publish_changes();
  void publish_update(const GraphChanges& changes, bool snapshot);

  Bus& bus_;
  GraphEstimator estimator_;
  std::vector<graph_node_t> nodes_;
  std::int64_t pose_seq_ = 0, graph_seq_ = 0, waiting_ = 0, refused_ = 0;
  std::int64_t polished_size_ = 0;  ///< nodes and loops at the last polish
  NodeId resend_from_ = -1;  ///< -1: nobody asked
};

/// Message to proposal. @throws BadMessage.
LoopProposal to_loop(const loop_closure_t& message);
loop_closure_t to_message(const LoopProposal& loop, std::int64_t utime, std::int64_t seq);

}  // namespace modslam
