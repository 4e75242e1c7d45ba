// SPDX-License-Identifier: BSD-3-Clause
/// procs/semantic_classifier — NODE + GRAPH (+ POSE, SYNC_REQUEST) → SEMANTIC_WALLS, _ROOMS,
/// _DOORS, _OBJECTS. Config: [semantics].
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/semantic_messages.hpp"
#include "common/bus/system_config.hpp"
#include "common/semantics/classifier.hpp"

namespace modslam {
namespace {

class SemanticClassifierModule : public Module {
 public:
  SemanticClassifierModule(Bus& bus, const SystemConfig& config)
      : bus_(bus), config_(config.semantics), classifier_(config.semantics), mirror_(bus) {
    mirror_.on_node = [this](const MirrorNode& node) {
      classifier_.insert(node.scan, node.sensor, node.T_map_base);
      changed_ = true;
      work(node.utime);
    };
    mirror_.on_update = [this](const std::vector<NodeId>& moved) {
      for (const NodeId id : moved) {
        const auto index = static_cast<std::size_t>(id);
        if (index < classifier_.scans())
          classifier_.set_pose(index, mirror_.nodes()[index].T_map_base);
      }
      moved_ = moved_ || !moved.empty();
      if (!mirror_.nodes().empty()) work(mirror_.nodes().back().utime);
    };
    mirror_.on_reset = [this] {
      classifier_.clear();
      changed_ = true;
    };
    bus.subscribe<sync_request_t>(channel::kSyncRequest, [this](const sync_request_t& m) {
      if (m.requester != bus_.name() && version_ > 0) publish();
    });
  }

  void finish() override {
    if (mirror_.nodes().empty()) return;
    render(true);
    if (changed_ || version_ == 0) publish_new();
  }

  std::string words() const override {
    const Semantics& s = classifier_.semantics();
    return std::to_string(s.walls.size()) + " walls, " + std::to_string(s.rooms.size()) +
           " rooms, " + std::to_string(s.doors.size()) + " doors, " +
           std::to_string(s.objects.size()) + " objects from " +
           std::to_string(classifier_.scans()) + " nodes, version " + std::to_string(version_);
  }

 private:
  /// At most every publish_s of message time.
  void work(std::int64_t utime) {
    if (!changed_ && !moved_) return;
    if (last_publish_ != 0 &&
        std::abs(static_cast<double>(utime - last_publish_)) < config_.publish_s * 1e6)
      return;
    last_publish_ = utime;
    render(false);
    if (changed_) publish_new();
  }

  void render(bool all) {
    if (moved_) changed_ = classifier_.redraw(all) > 0 || changed_;
    moved_ = false;
    if (changed_) classifier_.render(mirror_.nodes().back().utime);
  }

  void publish_new() {
    ++version_;
    changed_ = false;
    publish();
  }

  void publish() {
    const std::int64_t utime = mirror_.nodes().empty() ? 0 : mirror_.nodes().back().utime;
    const Semantics& s = classifier_.semantics();
    for (const auto& chunk : to_messages(s.walls, utime, version_))
      bus_.publish(channel::kWalls, chunk);
    for (const auto& chunk : to_messages(s.rooms, utime, version_))
      bus_.publish(channel::kRooms, chunk);
    for (const auto& chunk : to_messages(s.doors, utime, version_))
      bus_.publish(channel::kDoors, chunk);
    for (const auto& chunk : to_messages(s.objects, utime, version_))
      bus_.publish(channel::kObjects, chunk);
  }

  Bus& bus_;
  SemanticsConfig config_;
  SemanticClassifier classifier_;
  GraphMirror mirror_;
  bool changed_ = false, moved_ = false;
  std::int64_t last_publish_ = 0, version_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_semantic_classifier(Bus& bus, const SystemConfig& config) {
  return std::make_unique<SemanticClassifierModule>(bus, config);
}

}  // namespace modslam
