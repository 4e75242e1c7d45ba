// SPDX-License-Identifier: BSD-3-Clause
/// @file Open or closed: what the scans of all nodes say of each door, the newest most.
#pragma once
#include <functional>
#include <vector>

#include "common/scan/scan.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

enum class DoorLook { kNothing, kOpen, kClosed };

/// Beams that end on the line between the jambs say closed, beams that go through say open; few beams, or ones that graze it, say nothing.
DoorLook look_at_door(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base, const Door& door);

class DoorStates {
 public:
  struct View {
    const Scan& scan;
    const SensorInfo& sensor;
    const Pose2& T_map_base;
  };

  /// Sets `closed` of the doors of `now`, whose ids are known. Doors of `before` that are no opening any more stay, with the nodes that saw
  /// them, when they were seen open and are closed by now: a shut door is a wall to the map. Each door is asked of each node once.
  void update(const SemanticLayers& before, SemanticLayers& now, std::size_t n_nodes, const std::function<View(std::size_t)>& view);

 private:
  struct State {
    std::int64_t door = 0;          ///< id
    double log_odds = 1;            ///< of open: it was found as an opening
    int seen_open = 0;
    bool kept = false;              ///< it is no opening to the map any more
    std::size_t nodes_asked = 0;
    std::size_t witness = 0;        ///< the node that looked at it last
    Pose2 T_map_witness;            ///< where that node stood when the door's place was worked out
  };
  static bool stays(State& state, Door& door, std::size_t n_nodes, const std::function<View(std::size_t)>& view);
  static void ask(State& state, const Door& door, std::size_t n_nodes, const std::function<View(std::size_t)>& view);

  std::vector<State> states_;  ///< in the order of the doors that they were told of
};

}  // namespace modslam
