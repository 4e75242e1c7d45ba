// SPDX-License-Identifier: BSD-3-Clause
/// @file Keeps the semantic map in step with the pose graph (thesis 3.4): what each scan showed is worked out once, in the robot's frame;
/// after a loop closure only its place changes.
#pragma once
#include <map>
#include <vector>

#include "common/config/visitor.hpp"
#include "common/graph/types.hpp"
#include "common/maps/occupancy_map.hpp"
#include "common/semantics/door_map.hpp"
#include "common/semantics/evidence_grid.hpp"
#include "common/semantics/hough.hpp"
#include "common/semantics/room_finder.hpp"
#include "common/semantics/wall_map.hpp"

namespace modslam {

struct SemanticsConfig {
  static constexpr const char* kTable = "semantics";
  double publish_s = 3.0;
  double redraw_m = 0.03;
  double redraw_rad = 0.006;
  double range_limit_m = 20.0;
  double line_min_m = 0.5;
  double wall_min_m = 0.6;
  std::int64_t wall_sightings = 2;
  double door_min_m = 0.6;
  double door_max_m = 1.7;
  std::int64_t door_sightings = 4;
  double room_min_m2 = 2.5;
  double room_enclosed = 0.7;
  double room_explored = 0.6;
  double object_max_m2 = 14.0;

  void visit(ConfigVisitor& v) {
    v.number("publish_s", publish_s, 0, 600, "s", "Time between two publications of the semantic map.");
    v.number("redraw_m", redraw_m, 0, 1, "m", "Scans that moved less keep their place in the evidence until the end.");
    v.number("redraw_rad", redraw_rad, 0, 1, "rad", "Scans that turned less keep their place in the evidence until the end.");
    v.number("range_limit_m", range_limit_m, 1, 100, "m", "Longer beams say nothing of walls.");
    v.number("line_min_m", line_min_m, 0.1, 5, "m", "Shortest straight piece of one scan.");
    v.number("wall_min_m", wall_min_m, 0.1, 10, "m", "Shortest wall.");
    v.integer("wall_sightings", wall_sightings, 1, 100, "", "Scans that must have seen each stretch of a wall.");
    v.number("door_min_m", door_min_m, 0.2, 5, "m", "Narrowest door.");
    v.number("door_max_m", door_max_m, 0.3, 10, "m", "Widest door.");
    v.integer("door_sightings", door_sightings, 1, 1000, "", "Scans that must have looked through a door.");
    v.number("room_min_m2", room_min_m2, 0.2, 100, "m^2", "Smallest room.");
    v.number("room_enclosed", room_enclosed, 0, 1, "", "Share of a room's outline that must lie on walls or doors.");
    v.number("room_explored", room_explored, 0, 1, "", "Share of a room's area that must have been seen.");
    v.number("object_max_m2", object_max_m2, 0.01, 1000, "m^2", "Largest free-standing thing that is an object, not a block of building.");
  }
};

class SemanticMapper {
 public:
  explicit SemanticMapper(const SemanticsConfig& config);

  /// Ids must come in order: 0, 1, 2, ...
  void add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base);
  void set_pose(NodeId id, const Pose2& T_map_base) { nodes_[static_cast<std::size_t>(id)].wanted = T_map_base; }
  /// Works out walls, doors, rooms and objects anew; ids of what was there before stay. `settled`: the input has ended.
  const SemanticLayers& update(bool settled);
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
  void redraw(bool all);

  SemanticsConfig config_;
  OccupancyMap occupancy_{0.1, 20.0};
  EvidenceGrid evidence_;
  std::vector<NodeView> nodes_;
  SemanticLayers layers_;
  std::int64_t next_wall_ = 1, next_door_ = 1, next_room_ = 1, next_object_ = 1;
};

}  // namespace modslam
