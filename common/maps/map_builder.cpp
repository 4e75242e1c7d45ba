// SPDX-License-Identifier: BSD-3-Clause
#include "common/maps/map_builder.hpp"

namespace modslam {

void MapBuilder::add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) {
  drawings_.push_back({scan, sensor, T_map_base, T_map_base});
  map_.insert(scan, sensor, T_map_base);
}

int MapBuilder::redraw(bool all) {
  // At the end a move that no cell would show is still left.
  const double limit_m = all ? 0.05 * config_.resolution_m : config_.redraw_m;
  const double limit_rad = all ? 4e-4 : config_.redraw_rad;
  int count = 0;
  for (Drawing& d : drawings_) {
    if (distance(d.drawn, d.wanted) <= limit_m && std::abs(wrap_angle(d.drawn.heading - d.wanted.heading)) <= limit_rad) continue;
    map_.remove(d.scan, d.sensor, d.drawn);
    map_.insert(d.scan, d.sensor, d.wanted);
    d.drawn = d.wanted;
    ++count;
  }
  return count;
}

void MapBuilder::clear() {
  drawings_.clear();
  map_.clear();
}

}  // namespace modslam
