// SPDX-License-Identifier: BSD-3-Clause
/// @file The semantic classifier: scans at poses in, walls, doors, rooms and objects out.
///
/// insert: lines are extracted once, in the robot frame; evidence is added at the pose. set_pose
/// marks a scan that the graph moved; redraw takes it out and puts it in again. render derives the
/// vector map from the evidence; its cost depends on the size of the building, not on the number of
/// scans. Without clock: the same calls give the same map.
#pragma once
#include <vector>

#include "common/semantics/config.hpp"
#include "common/semantics/door_sensor.hpp"
#include "common/semantics/evidence.hpp"
#include "common/semantics/identities.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

class SemanticClassifier {
 public:
  explicit SemanticClassifier(const SemanticsConfig& config)
      : config_(config), evidence_(config.resolution_m) {}

  /// Scans are numbered 0, 1, 2, ... in the order of insertion.
  void insert(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base);
  void set_pose(std::size_t id, const Pose2& T_map_base) { scans_[id].wanted = T_map_base; }
  /// Inserts anew what lies elsewhere now; `all`: however little it moved. @return how many scans.
  int redraw(bool all);
  /// Evidence to map. @param utime  [us] of the newest scan.
  const Semantics& render(std::int64_t utime);
  void clear();

  const Semantics& semantics() const { return semantics_; }
  const Evidence& evidence() const { return evidence_; }
  std::size_t scans() const { return scans_.size(); }

 private:
  struct Inserted {
    EvidenceScan evidence;
    std::vector<JambPair> jambs;
    Pose2 drawn, wanted;
  };
  std::vector<Segment> jamb_pairs_map() const;

  SemanticsConfig config_;
  Evidence evidence_;
  std::vector<Inserted> scans_;
  Identities identities_;
  Semantics semantics_;
};

}  // namespace modslam
