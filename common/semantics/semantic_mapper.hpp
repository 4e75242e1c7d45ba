// SPDX-License-Identifier: BSD-3-Clause
/// @file Keeps the semantic map in step with the pose graph (thesis 3.4): what each scan showed is worked out once, in the robot's frame;
/// after a loop closure only its place changes.
#pragma once
#include <set>
#include <vector>

#include "common/graph/types.hpp"
#include "common/maps/occupancy_map.hpp"
#include "common/semantics/door_sensor.hpp"
#include "common/semantics/door_states.hpp"
#include "common/semantics/evidence_grid.hpp"
#include "common/semantics/hough.hpp"
#include "common/semantics/identities.hpp"
#include "common/semantics/interpret.hpp"
#include "common/semantics/semantics_config.hpp"

namespace modslam {

class SemanticMapper {
 public:
  explicit SemanticMapper(const SemanticsConfig& config);

  /// Ids must come in order: 0, 1, 2, ...
  void add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base);
  void set_pose(NodeId id, const Pose2& T_map_base);
  /// Works out walls, doors, rooms and objects where something changed; ids of what was there before stay. `settled`: the input has ended.
  const SemanticLayers& update(bool settled);
  /// All of it from the evidence, whatever was known before. Ids are left 0.
  SemanticLayers render() const;
  void clear();

 private:
  struct NodeView {
    Scan scan;
    SensorInfo sensor;
    LineExtraction lines;                 ///< robot frame
    std::vector<ScanPoint> points;
    std::vector<DoorSighting> doors;
    Pose2 drawn, wanted;
  };
  void draw(const NodeView& node, int sign);
  void show(const NodeView& node, Interpreter& interpreter, int sign) const;
  void redraw(bool all);

  SemanticsConfig config_;
  static constexpr double kCell_m = 0.05;
  LineExtractor lines_;
  OccupancyMap occupancy_;
  EvidenceGrid evidence_;
  KnownSpace space_;
  Interpreter interpreter_;
  std::vector<NodeView> nodes_;
  std::set<std::size_t> moved_;   ///< nodes that are not drawn just where they are wanted
  SemanticLayers layers_;
  Identities identities_;
  DoorStates door_states_;
};

}  // namespace modslam
