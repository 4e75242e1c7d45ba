// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/door_states.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace modslam {
namespace {

constexpr double kFar_m = 6.0;          // looks from farther away have few beams
constexpr double kAtLine_m = 0.2;       // a leaf hangs at a face of the wall
constexpr double kThrough_m = 0.35;     // what ends so far behind the line went through
constexpr double kLeastIncidence = 0.3;  // sine of the angle between beam and line
constexpr double kMiddle = 0.15;        // of the width beside each jamb says nothing
constexpr int kLeastBeams = 5;
constexpr double kClosedShare = 0.8, kOpenShare = 0.4;  // a leaf ajar hides half of the way
constexpr double kMost = 2;             // log-odds: three looks change the mind
constexpr int kSurelyOpen = 3;          // looks that said so
constexpr double kSameDoor_m = 0.5;

}  // namespace

DoorLook look_at_door(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base, const Door& door) {
  const Pose2 T_map_laser = T_map_base * sensor.T_base_laser;
  const Eigen::Vector2d eye = T_map_laser.translation(), along = door.b - door.a, to_jamb = door.a - eye;
  const double width_m = along.norm();
  int stopped = 0, through = 0;
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const double bearing_rad = T_map_laser.heading + scan.bearing_rad(k);
    const Eigen::Vector2d u(std::cos(bearing_rad), std::sin(bearing_rad));
    const double sine = (u.x() * along.y() - u.y() * along.x()) / width_m;
    if (!(std::abs(sine) > kLeastIncidence)) continue;
    const double line_m = (to_jamb.x() * along.y() - to_jamb.y() * along.x()) / (sine * width_m);
    const double share = (to_jamb.x() * u.y() - to_jamb.y() * u.x()) / (sine * width_m);
    if (line_m <= 0 || share < kMiddle || share > 1 - kMiddle) continue;
    const double range_m = is_return(scan.ranges_m[k], sensor) ? scan.ranges_m[k] : sensor.range_max_m;
    through += range_m > line_m + kThrough_m;
    stopped += is_return(scan.ranges_m[k], sensor) && std::abs(range_m - line_m) <= kAtLine_m;
  }
  const int all = stopped + through;
  if (all < kLeastBeams) return DoorLook::kNothing;
  if (stopped >= kClosedShare * all) return DoorLook::kClosed;
  return through >= kOpenShare * all ? DoorLook::kOpen : DoorLook::kNothing;
}

void DoorStates::ask(State& state, const Door& door, std::size_t n_nodes, const std::function<View(std::size_t)>& view) {
  for (; state.nodes_asked < n_nodes; ++state.nodes_asked) {
    const View node = view(state.nodes_asked);
    if ((node.T_map_base.translation() - door.centre()).norm() > kFar_m) continue;
    const DoorLook look = look_at_door(node.scan, node.sensor, node.T_map_base, door);
    if (look == DoorLook::kNothing) continue;
    state.seen_open += look == DoorLook::kOpen;
    state.log_odds = std::clamp(state.log_odds + (look == DoorLook::kOpen ? 1 : -1), -kMost, kMost);
    state.witness = state.nodes_asked;
  }
  if (n_nodes > 0) state.T_map_witness = view(state.witness).T_map_base;
}

/// Brings a door that is no opening any more to where its witness stands by now. @return whether it stays: it was seen open, and it has shut.
bool DoorStates::stays(State& state, Door& door, std::size_t n_nodes, const std::function<View(std::size_t)>& view) {
  if (state.seen_open < kSurelyOpen) return false;
  const Pose2 moved = view(state.witness).T_map_base * state.T_map_witness.inverse();
  door.a = moved * door.a;
  door.b = moved * door.b;
  ask(state, door, n_nodes, view);
  door.closed = state.log_odds < 0;
  state.kept = state.kept || door.closed;  // also when it opens again: the map is slower
  return state.kept;
}

void DoorStates::update(const SemanticLayers& before, SemanticLayers& now, std::size_t n_nodes, const std::function<View(std::size_t)>& view) {
  // Lists change little: most doors follow the one that they followed before.
  std::unordered_map<std::int64_t, std::size_t> others;
  std::vector<char> taken(states_.size(), false);
  std::size_t expected = 0;
  const auto find = [&](std::int64_t id) {
    if (expected < states_.size() && states_[expected].door == id) return expected++;
    if (others.empty())
      for (std::size_t k = 0; k < states_.size(); ++k) others.emplace(states_[k].door, k);
    const auto found = others.find(id);
    if (found == others.end()) return states_.size();
    expected = found->second + 1;
    return found->second;
  };
  std::vector<State> states;
  states.reserve(now.doors.size());
  for (Door& door : now.doors) {
    const std::size_t known = find(door.id);
    if (known < states_.size()) taken[known] = true;
    states.push_back(known < states_.size() ? states_[known] : State());
    State& state = states.back();
    state.door = door.id;
    ask(state, door, n_nodes, view);
    door.closed = state.log_odds < 0;
    state.kept = false;
  }
  // What is left is no opening any more.
  const std::size_t n_openings = now.doors.size();
  for (std::size_t k = 0; k < states_.size(); ++k) {
    if (taken[k]) continue;
    const auto opening = std::find_if(before.doors.begin(), before.doors.end(), [&](const Door& one) { return one.id == states_[k].door; });
    if (opening == before.doors.end()) continue;
    Door door = *opening;
    const auto is_same = [&](const Door& other) { return (other.centre() - door.centre()).norm() < kSameDoor_m; };
    if (std::any_of(now.doors.begin(), now.doors.begin() + static_cast<std::ptrdiff_t>(n_openings), is_same)) continue;
    if (!stays(states_[k], door, n_nodes, view)) continue;
    for (std::int64_t* room : {&door.room_a, &door.room_b})
      if (std::none_of(now.rooms.begin(), now.rooms.end(), [&](const Room& one) { return one.id == *room; })) *room = 0;
    states.push_back(states_[k]);
    now.doors.push_back(door);
  }
  states_ = std::move(states);
}

}  // namespace modslam
