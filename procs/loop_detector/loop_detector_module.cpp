// SPDX-License-Identifier: BSD-3-Clause
/// procs/loop_detector — NODE + GRAPH (+ POSE, to notice gaps) → LOOP. Config: [loop_detector], [scan_matcher] (range noise and limit).
#include "common/bus/channels.hpp"
#include "common/bus/estimator_session.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

class LoopDetectorModule : public Module {
 public:
  LoopDetectorModule(Bus& bus, const SystemConfig& config)
      : bus_(bus),
        detector_(config.loop_detector, config.scan_matcher.sigma_range_m, config.scan_matcher.range_limit_m),
        mirror_(bus) {
    mirror_.on_node = [this](const MirrorNode& node) {
      detector_.add_node(node.id, node.T_map_base, node.scan, node.sensor);
      fresh_ = true;
    };
    mirror_.on_update = [this](const std::vector<NodeId>& moved) {
      for (const NodeId id : moved) detector_.set_pose(id, mirror_.nodes()[static_cast<std::size_t>(id)].T_map_base);
      if (fresh_ && mirror_.complete()) look();
    };
    mirror_.on_reset = [this] { detector_.clear(); };
  }

  std::string words() const override {
    return std::to_string(mirror_.nodes().size()) + " nodes, " + std::to_string(seq_) + " places looked at, " +
           std::to_string(usable_) + " recognised";
  }

 private:
  /// The edge to the newest node has come with the update: its place is known now.
  void look() {
    fresh_ = false;
    if (!detector_.wants_to_look()) return;
    std::vector<const GraphEdge*> edges;
    const auto known = static_cast<NodeId>(mirror_.nodes().size());
    for (const auto& [id, edge] : mirror_.edges())
      if (edge.from < known && edge.to < known) edges.push_back(&edge);
    for (const LoopProposal& loop : detector_.detect(edges)) {
      usable_ += is_usable(loop.verdict);
      bus_.publish(channel::kLoop, to_message(loop, mirror_.nodes().back().utime, ++seq_));
    }
  }

  Bus& bus_;
  LoopDetector detector_;
  GraphMirror mirror_;
  bool fresh_ = false;
  std::int64_t seq_ = 0, usable_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_loop_detector(Bus& bus, const SystemConfig& config) {
  return std::make_unique<LoopDetectorModule>(bus, config);
}

}  // namespace modslam
