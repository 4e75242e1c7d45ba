// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/semantic_mapper.hpp"

#include <algorithm>

#include "common/semantics/interpret.hpp"

namespace modslam {

SemanticMapper::SemanticMapper(const SemanticsConfig& config) : config_(config), model_(config.opening_trees), occupancy_(kCell_m, config.range_limit_m) {}

void SemanticMapper::clear() { *this = SemanticMapper(config_); }

void SemanticMapper::add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) {
  NodeView node{scan, sensor, {}, {}, {}, T_map_base, T_map_base};
  node.points = points_base(scan, sensor);
  node.points.erase(std::remove_if(node.points.begin(), node.points.end(), [&](const ScanPoint& p) { return p.range_m > config_.range_limit_m; }),
                    node.points.end());
  HoughOptions hough;
  hough.min_length_m = config_.line_min_m;
  node.lines = extract_lines(node.points, sensor.T_base_laser.translation(), std::abs(scan.radstep), hough);
  DoorSensorOptions doors;
  doors.min_width_m = config_.door_min_m;
  doors.max_width_m = config_.door_max_m;
  node.doors = sight_doors(scan, sensor, doors);
  draw(node, 1);
  nodes_.push_back(std::move(node));
}

void SemanticMapper::draw(const NodeView& node, int sign) {
  if (sign > 0)
    occupancy_.insert(node.scan, node.sensor, node.drawn);
  else
    occupancy_.remove(node.scan, node.sensor, node.drawn);
  for (std::size_t k = 0; k < node.points.size(); ++k) evidence_.add(node.drawn * node.points[k].p, node.lines.on_segment[k], sign);
}

void SemanticMapper::redraw(bool all) {
  const double limit_m = all ? 0.1 * config_.redraw_m : config_.redraw_m, limit_rad = all ? 0.1 * config_.redraw_rad : config_.redraw_rad;
  for (NodeView& node : nodes_) {
    if (distance(node.drawn, node.wanted) <= limit_m && std::abs(wrap_angle(node.drawn.heading - node.wanted.heading)) <= limit_rad) continue;
    draw(node, -1);
    node.drawn = node.wanted;
    draw(node, 1);
  }
}

SemanticLayers SemanticMapper::render() const {
  SemanticEvidence evidence{KnownSpace(occupancy_), {}, {}, [this](const Eigen::Vector2d& p) { return evidence_.log_odds(p); }};
  for (const NodeView& node : nodes_) {
    PlacedSegments placed;
    for (Segment segment : node.lines.segments) {
      segment.a = node.wanted * segment.a;
      segment.b = node.wanted * segment.b;
      placed.push_back(segment);
    }
    evidence.scans.push_back(std::move(placed));
    for (const DoorSighting& door : node.doors) evidence.sightings.push_back({node.wanted * door.a, node.wanted * door.b});
  }
  return interpret(evidence, config_, model_);
}

const SemanticLayers& SemanticMapper::update(bool settled) {
  redraw(settled);
  SemanticLayers layers = render();
  identities_.carry_over(layers_, layers);
  layers_ = std::move(layers);
  return layers_;
}

}  // namespace modslam
