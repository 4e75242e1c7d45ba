// SPDX-License-Identifier: BSD-3-Clause
/// @file Where in a known map is a robot that knows nothing, or not any more?
///
/// Every so often a scan is tried at all places near where the map was made from, in all headings; what fits nearly as well as the best is kept as hypotheses,
/// beside those of earlier scans carried along by the robot's own tracking. Each hypothesis is then judged by all the scans since the robot got lost: how much of
/// them lies on known walls, how many of their beams would have to pass through one. An answer is given when one hypothesis is left
/// and the robot has moved enough for two look-alike places to have told themselves apart; until then it keeps looking.
/// Many rough poses sieved and the rest refined after Filotheou (CBGL, IROS 2024); hypotheses over the path after Fox et al., JAIR 1999, without the random draws.
#pragma once
#include <deque>
#include <utility>
#include <vector>

#include "common/graph/types.hpp"
#include "common/matching/submap.hpp"
#include "common/matching/verdict.hpp"

namespace modslam {

class Relocalizer {
 public:
  Relocalizer(double sigma_range_m, double range_limit_m) : noise_{sigma_range_m, 1e-3}, range_limit_m_(range_limit_m) {}

  /// The map: nodes in any order, poses as the map has them. @throws std::logic_error after the first look().
  void add_node(NodeId id, const Pose2& T_map_base, const Scan& scan, const SensorInfo& sensor);
  void add_node(NodeId id, Keyframe node);
  std::size_t nodes() const { return nodes_.size(); }

  struct Answer {
    Verdict verdict = Verdict::kFirst;  ///< kOk: the robot is there; kAmbiguous: not sure yet; kFailed: nothing fits; kFirst: too little seen
    Pose2 T_map_base;                   ///< of the best hypothesis
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of the last scan's match, map frame, order x y heading
    NodeId nearest = -1;                ///< node of the map next to it
    double posterior = 0;               ///< of the best hypothesis, 0..1
    double overlap = 0;                 ///< share of the scans' points that lie on known walls there, mean
    int hypotheses = 0, scans = 0;
    bool is_of_this_scan = true;  ///< false: of an earlier one taken near by
  };
  /// One scan more. @param T_track_base where the robot's own tracking says it is, in a frame that stays put since the last forget().
  /// Scans taken near the one before change nothing and cost nothing.
  Answer look(const Scan& scan, const SensorInfo& sensor, const Pose2& T_track_base);
  /// The same of a scan whose points are oriented already; its pose is where the tracking says it was taken.
  Answer look(const Keyframe& scan);
  /// The robot has lost its own track: what was seen before says nothing about what comes.
  void forget();

  /// The robot is near `guess` [map frame]: where exactly? One match against the whole map.
  Answer locate(const Scan& scan, const SensorInfo& sensor, const Pose2& guess);

 private:
  struct Seen {
    Pose2 T_track_base;
    std::vector<OrientedPoint> points_base;
    Eigen::Vector2d eye_base;
  };
  struct Hypothesis {
    Pose2 T_map_track;
    double log_likelihood = 0, overlap = 0, worst_overlap = 1, free_violation = 0;
    RefineResult fit;  ///< of the newest scan
  };
  void prepare();
  void propose(const Seen& seen);
  std::vector<Pose2> rough_guesses(const std::vector<Eigen::Vector2d>& points_base) const;
  void judge(Hypothesis& hypothesis) const;
  void merge();
  Answer answer() const;
  Answer stale() const;
  double free_violation(const Seen& seen, const Pose2& T_map_base) const;
  NodeId nearest_node(const Pose2& T_map_base) const;

  RangeNoise noise_;
  double range_limit_m_;
  std::vector<Keyframe> nodes_;
  std::vector<NodeId> ids_;
  Submap map_;
  std::vector<Eigen::Vector2d> places_;  ///< tried by a search
  ScoreGrid wide_grid_{0.2}, grid_{0.1};
  bool prepared_ = false;
  std::deque<Seen> seen_;
  std::vector<Hypothesis> hypotheses_;
  int looks_ = 0;
  Answer last_;
};

}  // namespace modslam
