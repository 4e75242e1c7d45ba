// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/semantic_mapper.hpp"

#include <algorithm>
#include <utility>

namespace modslam {

namespace {

HoughOptions line_options(const SemanticsConfig& config) {
  HoughOptions options;
  options.min_length_m = config.line_min_m;
  return options;
}

}  // namespace

SemanticMapper::SemanticMapper(const SemanticsConfig& config)
    : config_(config), lines_(line_options(config)), occupancy_(kCell_m, config.range_limit_m), evidence_(kCell_m), space_(kCell_m), interpreter_(config) {}

void SemanticMapper::clear() { *this = SemanticMapper(config_); }

void SemanticMapper::add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) {
  NodeView node{scan, sensor, {}, {}, {}, T_map_base, T_map_base};
  node.points = points_base(scan, sensor);
  node.points.erase(std::remove_if(node.points.begin(), node.points.end(), [&](const ScanPoint& p) { return p.range_m > config_.range_limit_m; }),
                    node.points.end());
  node.lines = lines_(node.points, sensor.T_base_laser.translation(), std::abs(scan.radstep));
  DoorSensorOptions doors;
  doors.min_width_m = config_.door_min_m;
  doors.max_width_m = config_.door_max_m;
  node.doors = sight_doors(scan, sensor, doors);
  draw(node, 1);
  nodes_.push_back(std::move(node));
}

void SemanticMapper::set_pose(NodeId id, const Pose2& T_map_base) {
  const auto k = static_cast<std::size_t>(id);
  NodeView& node = nodes_[k];
  node.wanted = T_map_base;
  if (distance(node.drawn, node.wanted) == 0 && node.drawn.heading == node.wanted.heading) moved_.erase(k);
  else moved_.insert(k);
}

void SemanticMapper::draw(const NodeView& node, int sign) {
  if (sign > 0)
    occupancy_.insert(node.scan, node.sensor, node.drawn);
  else
    occupancy_.remove(node.scan, node.sensor, node.drawn);
  const PointMover to_map(node.drawn);
  for (std::size_t k = 0; k < node.points.size(); ++k) evidence_.add(to_map * node.points[k].p, node.lines.on_segment[k], sign);
  show(node, interpreter_, sign);
}

void SemanticMapper::show(const NodeView& node, Interpreter& interpreter, int sign) const {
  for (Segment segment : node.lines.segments) {
    segment.a = node.drawn * segment.a;
    segment.b = node.drawn * segment.b;
    interpreter.add(segment, sign);
  }
  for (const DoorSighting& door : node.doors) interpreter.add(DoorSighting{node.drawn * door.a, node.drawn * door.b}, sign);
}

void SemanticMapper::redraw(bool all) {
  const double limit_m = all ? 0.1 * config_.redraw_m : config_.redraw_m, limit_rad = all ? 0.1 * config_.redraw_rad : config_.redraw_rad;
  for (auto moved = moved_.begin(); moved != moved_.end();) {
    NodeView& node = nodes_[*moved];
    if (distance(node.drawn, node.wanted) <= limit_m && std::abs(wrap_angle(node.drawn.heading - node.wanted.heading)) <= limit_rad) {
      ++moved;
      continue;
    }
    draw(node, -1);
    node.drawn = node.wanted;
    draw(node, 1);
    moved = moved_.erase(moved);
  }
}

SemanticLayers SemanticMapper::render() const {
  KnownSpace space(kCell_m);
  Interpreter interpreter(config_);
  for (const NodeView& node : nodes_) show(node, interpreter, 1);
  const auto tiles = occupancy_.tiles();
  const Boxes changed = space.update(occupancy_, {tiles.begin(), tiles.end()});
  SemanticLayers layers;
  interpreter.update(space, changed, [this](const Eigen::Vector2d& p) { return evidence_.log_odds(p); }, {}, layers);
  return layers;
}

const SemanticLayers& SemanticMapper::update(bool settled) {
  redraw(settled);
  const Boxes changed = space_.update(occupancy_, occupancy_.take_changed());
  Boxes odds;
  for (const auto& [x, y, side] : evidence_.take_changed()) odds.emplace_back(x, y, side, side);
  SemanticLayers before;
  before.doors = std::exchange(layers_.doors, {});
  before.rooms = std::exchange(layers_.rooms, {});
  before.objects = std::exchange(layers_.objects, {});
  before.walls = interpreter_.update(space_, changed, [this](const Eigen::Vector2d& p) { return evidence_.log_odds(p); }, odds, layers_);
  identities_.carry_over(before, layers_);
  door_states_.update(before, layers_, nodes_.size(), [this](std::size_t k) { return DoorStates::View{nodes_[k].scan, nodes_[k].sensor, nodes_[k].drawn}; });
  return layers_;
}

}  // namespace modslam
