// SPDX-License-Identifier: BSD-3-Clause
/// procs/loop_detector — NODE + GRAPH (+ POSE, to notice gaps; SYNC_REQUEST) → LOOP, LOOP_SEARCH. Config: [loop_detector], [scan_matcher] (range noise and limit).
#include <modslam/loop_search_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/estimator_session.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/journal.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

class LoopDetectorModule : public Module {
 public:
  LoopDetectorModule(Bus& bus, const SystemConfig& config)
      : bus_(bus),
        detector_(config.loop_detector, config.scan_matcher.sigma_range_m, config.scan_matcher.range_limit_m),
        mirror_(bus),
        journal_(config.journal, bus.name()) {
    resume();
    mirror_.on_update = [this](const std::vector<NodeId>& moved) {
      for (const NodeId id : moved)
        if (id < added_) detector_.set_pose(id, pose(id));
      if (mirror_.complete()) look_at_new_nodes();
    };
    mirror_.on_reset = [this] {
      detector_.clear();
      said_.clear();
      added_ = 0;
      looked_at_ = -1;
    };
    bus.subscribe<sync_request_t>(channel::kSyncRequest, [this](const sync_request_t& m) {
      if (m.requester != "graph_optimizer") return;  // it has lost a LOOP; those that it knows it will not count twice
      for (const loop_closure_t& loop : said_) bus_.publish(channel::kLoop, loop);
    });
  }

  void tick(std::int64_t steady_us) override { mirror_.tick(steady_us); }
  bool complete() const override { return mirror_.settled(); }
  void missed(const std::string& channel) override {
    if (channel == channel::kNode || channel == channel::kGraph) mirror_.suspect();
  }
  std::string words() const override {
    return std::to_string(mirror_.nodes().size()) + " nodes, " + std::to_string(said_.size()) + " places looked at, " +
           std::to_string(usable_) + " recognised" + (journal_.trouble().empty() ? "" : "; " + journal_.trouble());
  }

 private:
  /// What was said in the life before; the last word tells how far it had looked.
  void resume() {
    loop_closure_t loop{};
    journal_.read_past([&](const LogEvent& record) {
      if (!read_record(record, loop)) return;
      said_.push_back(loop);
      usable_ += is_usable(static_cast<Verdict>(loop.verdict));
      looked_at_ = loop.to_node;
    });
  }

  Pose2 pose(NodeId id) const { return mirror_.nodes()[static_cast<std::size_t>(id)].T_map_base; }

  /// One after the other, as if each were the newest: several come at once after a gap or a restart.
  void look_at_new_nodes() {
    for (; added_ < static_cast<NodeId>(mirror_.nodes().size()); ++added_) {
      const MirrorNode& node = mirror_.nodes()[static_cast<std::size_t>(added_)];
      detector_.add_node(node.id, node.T_map_base, node.scan, node.sensor);
      if (added_ == looked_at_) detector_.resume_after_newest();
      if (added_ > looked_at_) look(node);
      loop_search_t searched{};
      searched.utime = node.utime;
      searched.node = node.id;
      searched.proposals = static_cast<std::int64_t>(said_.size());
      bus_.publish(channel::kLoopSearch, searched);
    }
  }

  void look(const MirrorNode& node) {
    std::vector<const GraphEdge*> edges;
    for (const GraphEdge& edge : mirror_.edges())
      if (edge.from <= node.id && edge.to <= node.id) edges.push_back(&edge);
    for (const LoopProposal& loop : detector_.detect(edges)) {
      usable_ += is_usable(loop.verdict);
      said_.push_back(to_message(loop, node.utime, static_cast<std::int64_t>(said_.size()) + 1));
      bus_.publish(channel::kLoop, said_.back());
      journal_.write("LOOP", said_.back());
    }
  }

  Bus& bus_;
  LoopDetector detector_;
  GraphMirror mirror_;
  Journal journal_;
  std::vector<loop_closure_t> said_;
  NodeId added_ = 0, looked_at_ = -1;
  std::int64_t usable_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_loop_detector(Bus& bus, const SystemConfig& config) {
  return std::make_unique<LoopDetectorModule>(bus, config);
}

}  // namespace modslam
