// SPDX-License-Identifier: BSD-3-Clause
/// @file The graph estimator: where the robot is, which nodes and edges there are, which loops are believed.
///
/// Loop proposals that agree with what the graph knows and that it knows well become edges at once; others wait until enough of
/// them agree with each other along the driven way (pairwise consistency; Mangelson et al., ICRA 2018). Accepted loops
/// stay on trial: one that the optimised graph contradicts is retracted.
#pragma once
#include <deque>
#include <string>
#include <vector>

#include "common/config/visitor.hpp"
#include "common/graph/known_space.hpp"
#include "common/graph/pose_graph.hpp"
#include "common/graph/toro.hpp"
#include "common/loops/loop_detector.hpp"
#include "common/motion/proposal.hpp"

namespace modslam {

struct EstimatorConfig {
  static constexpr const char* kTable = "graph_optimizer";
  std::string method = "gauss-newton";
  std::string proposal = "deterministic";
  std::int64_t seed = 1;
  double node_m = 0.30;
  double node_rad = 0.35;
  std::int64_t full_at = 4;
  double trusted_sigma_m = 0.35;
  std::int64_t confirmations = 2;
  double dcs_phi = 10.0;
  double retract_chi2 = 16.3;
  std::int64_t postpone = 10;
  double moved_m = 0.002;
  double moved_rad = 0.0005;
  bool polish = true;

  void visit(ConfigVisitor& v) {
    v.choice("method", method, {"gauss-newton", "toro"}, "Optimiser of the pose graph.");
    v.choice("proposal", proposal, {"deterministic", "sampled"}, "Next pose: the most likely one, or drawn from the fused Gaussian.");
    v.integer("seed", seed, 0, 1'000'000'000, "", "Of the sampled proposal.");
    v.number("node_m", node_m, 0.05, 10, "m", "Way after which a scan becomes a node.");
    v.number("node_rad", node_rad, 0.05, 3.2, "rad", "Turn after which a scan becomes a node.");
    v.integer("full_at", full_at, 0, 1000, "", "Nodes within 0.6 m and 0.75 rad after which a place gets no more of them; 0: it always does.");
    v.number("trusted_sigma_m", trusted_sigma_m, 0.01, 100, "m", "Loops between nodes known better than this need no confirmation.");
    v.integer("confirmations", confirmations, 0, 20, "", "Other loops that must agree with a far one before it is believed.");
    v.number("dcs_phi", dcs_phi, 0, 1e6, "", "Chi-square from which a loop edge loses weight; 0: never.");
    v.number("retract_chi2", retract_chi2, 1, 1e9, "", "Chi-square in the optimised graph at which a loop edge is taken back.");
    v.integer("postpone", postpone, 1, 1000, "", "Loops that change nothing much are optimised together, at most so many.");
    v.number("moved_m", moved_m, 0, 1, "m", "Smaller moves of a node are not published.");
    v.number("moved_rad", moved_rad, 0, 1, "rad", "Smaller turns of a node are not published.");
    v.flag("polish", polish, "At the end, compare every scan with the scans around it and refine all poses together.");
  }
};

enum class LoopFate { kRefused, kWaiting, kAccepted };

/// What happened since the last call; feeds the GRAPH message.
struct GraphChanges {
  std::vector<GraphEdge> added;
  std::vector<EdgeId> retracted;
  std::vector<NodeId> moved;
  bool empty() const { return added.empty() && retracted.empty() && moved.empty(); }
};

/// What an estimator knows beyond its configuration: enough to go on after the process was killed.
struct EstimatorMemory {
  PoseGraph graph;
  EdgeId next_edge = 0;
  Anchorage robot;                                          ///< the node it hangs on, and its place relative to that one
  Pose2 T_step_base;                                        ///< motion since it was last asked whether a node is due
  std::deque<LoopProposal> waiting;                         ///< for others that confirm them
  std::int64_t postponed = 0, epoch = 0, accepted = 0, retracted = 0;
};

class GraphEstimator {
 public:
  explicit GraphEstimator(const EstimatorConfig& config) : config_(config), random_(static_cast<std::uint64_t>(config.seed)) {}

  struct Step {
    Pose2 T_map_base;
    Eigen::Matrix3d covariance;  ///< of T_node_base, additive, frame of the node
    NodeId node = 0;             ///< that the robot hangs on
    Pose2 T_node_base;
    bool is_new_node = false;
    NodeId node_before = -1;  ///< where this scan gave it a new place: the node that it hung on until then
    Pose2 T_before_base;      ///< and its place by that one
  };
  /// One scan further. `measurements` speak of the motion since the last scan; empty for the first scan.
  /// @param localize asked before a place that is full would get another node; without it, it gets one.
  /// @param may_be_node false for a scan that was not recognised: it may have been taken anywhere.
  Step move(const std::vector<MotionMeasurement>& measurements, const Localize& localize = {}, bool may_be_node = true);
  /// The robot was carried away: a node where nothing else is, tied to the rest by a break edge. Loops that confirm each other bring it
  /// and all that follows to where it belongs.
  Step begin_apart();
  /// First node of the part that the robot is in; 0: it is not lost.
  NodeId part_of_robot() const;

  LoopFate add_loop(const LoopProposal& proposal);
  /// Optimises what was postponed; `thoroughly` to convergence (end of a run).
  void settle(bool thoroughly);
  /// Moves the nodes to where all edges together with these measurements want them; the measurements are not kept. Loops that they
  /// contradict are retracted.
  void polish(const std::vector<GraphEdge>& overlaps);

  /// Goes on from what another estimator of the same configuration knew. A sampled proposal draws other numbers than it would have.
  void resume(EstimatorMemory memory);

  GraphChanges take_changes();
  const PoseGraph& graph() const { return graph_; }
  /// Edges in force by pointer, in order of id.
  std::vector<const GraphEdge*> edges() const;
  std::int64_t epoch() const { return epoch_; }
  std::int64_t postponed() const { return postponed_; }
  std::int64_t accepted() const { return accepted_; }
  std::int64_t retracted() const { return retracted_; }
  /// How often a scan was hung on an old node instead of making a new one.
  std::int64_t reused() const { return reused_; }
  const Anchorage& robot() const { return robot_; }
  const Pose2& T_step_base() const { return T_step_base_; }

 private:
  void append_node();
  void append_node(const GraphEdge& edge, const Pose2& T_map_node);
  Step step_here() const;
  void join_parts(const LoopProposal& loop);
  bool stay_in_known_space(const Localize& localize);
  Anchorage seen_from(NodeId node) const;
  bool is_news(const GraphEdge& edge) const;
  void accept(GraphEdge edge);
  bool agrees_with_graph(const LoopProposal& loop, bool& trusted) const;
  bool consistent(const LoopProposal& a, const LoopProposal& b) const;
  void optimize(bool thoroughly);
  void note_moves();
  bool retract_worst(std::size_t among_first);

  EstimatorConfig config_;
  std::mt19937_64 random_;
  PoseGraph graph_;
  EdgeId next_edge_ = 0;
  Anchorage robot_;
  Pose2 T_step_base_;
  std::deque<LoopProposal> waiting_;
  Toro toro_;
  std::vector<Pose2> published_poses_;
  GraphChanges changes_;
  std::int64_t postponed_ = 0, epoch_ = 0, accepted_ = 0, retracted_ = 0, reused_ = 0;
};

}  // namespace modslam
