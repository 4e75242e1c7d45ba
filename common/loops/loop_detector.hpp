// SPDX-License-Identifier: BSD-3-Clause
/// @file Finds places seen before and measures how they lie to the present scan (thesis, algorithm 3, mended).
///
/// A node enters the quad tree only when the robot has since driven `delay_m` further, so trivially small loops never show.
/// A new node looks for tree nodes within what the graph's own relative covariance allows, keeps those that its beams reach (a wall
/// between them hides a node), renders the affected nodes of one earlier pass into a local map and matches its scan to it.
/// Differences from the thesis (docs/decisions.md): the radius comes from the covariance, every match carries a verdict, and
/// nothing becomes an edge here: proposals are judged once more by the estimator.
#pragma once
#include <deque>
#include <optional>
#include <vector>

#include "common/config/visitor.hpp"
#include "common/graph/types.hpp"
#include "common/loops/place_match.hpp"
#include "common/loops/quad_tree.hpp"
#include "common/loops/relocalizer.hpp"

namespace modslam {

struct LoopDetectorConfig {
  static constexpr const char* kTable = "loop_detector";
  double delay_m = 8.0;
  double close_m = 3.0;
  double max_radius_m = 12.0;
  double beam_near_m = 1.0;
  double cooldown_m = 0.5;
  std::int64_t passes = 2;
  double pass_m = 5.0;
  double min_overlap = 0.55;
  double max_chi2 = 12.0;
  double max_ambiguity = 0.92;
  double information_scale = 0.10;
  PlaceLimits limits() const { return {min_overlap, max_chi2, max_ambiguity, information_scale}; }

  void visit(ConfigVisitor& v) {
    v.number("delay_m", delay_m, 0.5, 500, "m", "A node can be recognised after the robot drove this much further.");
    v.number("close_m", close_m, 0.1, 50, "m", "Old nodes this near are always looked at, whatever the covariance says.");
    v.number("max_radius_m", max_radius_m, 0.5, 100, "m", "Old nodes farther away than this never are.");
    v.number("beam_near_m", beam_near_m, 0.1, 10, "m", "An old node is affected when a beam passes it this closely.");
    v.number("cooldown_m", cooldown_m, 0, 50, "m", "Way between two nodes that look for loops.");
    v.integer("passes", passes, 1, 10, "", "Earlier visits of a place that are matched separately.");
    v.number("pass_m", pass_m, 0.5, 50, "m", "Way before and after the nearest old node that is rendered.");
    v.number("min_overlap", min_overlap, 0, 1, "", "Share of the points that must find a partner.");
    v.number("max_chi2", max_chi2, 0.1, 1000, "", "Largest reduced chi-square of the residuals.");
    v.number("max_ambiguity", max_ambiguity, 0.1, 1, "", "Score of the second-best place over the best above which the place is not known.");
    v.number("information_scale", information_scale, 1e-4, 1, "", "Share of a match's information that counts.");
  }
};

struct LoopProposal {
  NodeId from = 0, to = 0;  ///< old node, new node
  Pose2 T_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< in the frame of `to`, order x y heading; 0 where nothing was seen
  Verdict verdict = Verdict::kInvalid;
  MatchFigures figures;
  std::vector<NodeId> affected;
};

class LoopDetector {
 public:
  explicit LoopDetector(const LoopDetectorConfig& config, double sigma_range_m, double range_limit_m)
      : config_(config), noise_{sigma_range_m, 1e-3}, range_limit_m_(range_limit_m) {}

  /// Ids must come in order: 0, 1, 2, ...
  void add_node(NodeId id, const Pose2& T_map_base, const Scan& scan, const SensorInfo& sensor);
  void set_pose(NodeId id, const Pose2& T_map_base);
  /// Whether the robot has come far enough since the last place that was recognised or looked at.
  bool wants_to_look() const { return !nodes_.empty() && way_m_.back() - last_look_m_ >= config_.cooldown_m; }
  /// Looks for loops of the newest node. @param edges the graph as it is now.
  std::vector<LoopProposal> detect(const std::vector<const GraphEdge*>& edges);
  /// An earlier life of this detector looked at the newest node already.
  void resume_after_newest() { last_look_m_ = way_m_.back(); }
  void clear();

 private:
  struct Candidate {
    NodeId id;
    double distance_m;
    Eigen::Matrix3d cov;  ///< relative to the newest node, its frame
  };
  void insert_delayed_nodes();
  void rebuild_tree();
  std::vector<Candidate> visible_candidates(const std::vector<const GraphEdge*>& edges) const;
  std::vector<std::vector<Candidate>> split_into_passes(std::vector<Candidate> candidates) const;
  LoopProposal match(const Keyframe& now, const std::vector<Candidate>& pass) const;
  std::optional<LoopProposal> find_in_other_parts(const std::vector<NodeId>& parts);
  std::optional<LoopProposal> match_at(const Pose2& T_map_found, const std::vector<NodeId>& parts) const;

  LoopDetectorConfig config_;
  RangeNoise noise_;
  double range_limit_m_;
  std::vector<Keyframe> nodes_;             ///< by id; pose in the map frame
  std::vector<double> way_m_;               ///< driven up to each node
  std::vector<std::vector<Eigen::Vector2d>> beams_base_;  ///< thinned endpoints of each node's scan
  QuadTree tree_;
  NodeId next_in_tree_ = 0;
  bool tree_stale_ = false;
  double last_look_m_ = -1e9;
  std::optional<Relocalizer> relocalizer_;  ///< while the newest node's part of the graph is not the first one
  NodeId relocalized_part_ = 0;
};

}  // namespace modslam
