// SPDX-License-Identifier: BSD-3-Clause
/// @file Keeps the occupancy map in step with the pose graph (thesis: incrementStep and updateStep of the map builder).
#pragma once
#include "common/config/visitor.hpp"
#include "common/graph/types.hpp"
#include "common/maps/occupancy_map.hpp"

namespace modslam {

struct MapBuilderConfig {
  static constexpr const char* kTable = "map_builder";
  double resolution_m = 0.05;
  double range_limit_m = 30.0;
  double publish_s = 2.0;
  double redraw_s = 4.0;
  double redraw_m = 0.05;
  double redraw_rad = 0.01;

  void visit(ConfigVisitor& v) {
    v.number("resolution_m", resolution_m, 0.005, 1, "m", "Side of a cell.");
    v.number("range_limit_m", range_limit_m, 1, 200, "m", "Beams are drawn up to this length.");
    v.number("publish_s", publish_s, 0, 60, "s", "Time between two publications of changed tiles.");
    v.number("redraw_s", redraw_s, 0, 600, "s", "Time between two redraws of scans that the graph has moved.");
    v.number("redraw_m", redraw_m, 0, 1, "m", "Scans that moved less are left as drawn until the end.");
    v.number("redraw_rad", redraw_rad, 0, 1, "rad", "Scans that turned less are left as drawn until the end.");
  }
};

class MapBuilder {
 public:
  explicit MapBuilder(const MapBuilderConfig& config)
      : config_(config), map_(config.resolution_m, config.range_limit_m) {}

  /// Ids must come in order: 0, 1, 2, ...
  void add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base);
  void set_pose(NodeId id, const Pose2& T_map_base) { drawings_[static_cast<std::size_t>(id)].wanted = T_map_base; }
  /// Draws scans anew that lie elsewhere now; `all`: however little they moved. @return how many.
  int redraw(bool all);
  void clear();

  OccupancyMap& map() { return map_; }

 private:
  struct Drawing {
    Scan scan;
    SensorInfo sensor;
    Pose2 drawn, wanted;
  };
  MapBuilderConfig config_;
  OccupancyMap map_;
  std::vector<Drawing> drawings_;
};

}  // namespace modslam
