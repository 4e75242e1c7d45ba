// SPDX-License-Identifier: BSD-3-Clause
/// procs/map_builder — NODE + GRAPH (+ POSE, SYNC_REQUEST) → MAP_TILE. Config: [map_builder].
#include <modslam/map_tile_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"
#include "common/maps/mosaic.hpp"

namespace modslam {
namespace {

constexpr int kTilesPerTick = 20;  // so that a large map does not flood the network at once

class MapBuilderModule : public Module {
 public:
  MapBuilderModule(Bus& bus, const SystemConfig& config)
      : bus_(bus), config_(config.map_builder), builder_(config.map_builder), mirror_(bus) {
    mirror_.on_node = [this](const MirrorNode& node) {
      builder_.add_node(node.scan, node.sensor, node.T_map_base);
      work(node.utime);
    };
    mirror_.on_update = [this](const std::vector<NodeId>& moved) {
      for (const NodeId id : moved) builder_.set_pose(id, mirror_.nodes()[static_cast<std::size_t>(id)].T_map_base);
      if (!mirror_.nodes().empty()) work(mirror_.nodes().back().utime);
    };
    mirror_.on_reset = [this] { builder_.clear(); };
    bus.subscribe<sync_request_t>(channel::kSyncRequest, [this](const sync_request_t& m) {
      if (m.requester == bus_.name()) return;
      for (const auto& index : builder_.map().tiles()) changed_.insert(index);
      urgent_ = true;  // even when the robot stands still
    });
  }

  void finish() override {
    builder_.redraw(true);
    collect();
    while (!changed_.empty()) publish_some();
  }

  void tick(std::int64_t steady_us) override {
    mirror_.tick(steady_us);
    if (urgent_) publish_some();
  }

  bool complete() const override { return mirror_.settled(); }
  void missed(const std::string& channel) override {
    if (channel == channel::kNode || channel == channel::kGraph) mirror_.suspect();
  }
  std::string words() const override {
    return std::to_string(mirror_.nodes().size()) + " nodes, version " + std::to_string(version_) + ", " +
           std::to_string(redrawn_) + " scans redrawn";
  }

 private:
  /// At most every redraw_s and publish_s of message time.
  void work(std::int64_t utime) {
    if (due(utime, last_redraw_, config_.redraw_s)) redrawn_ += builder_.redraw(false);
    if (!due(utime, last_publish_, config_.publish_s)) return;
    collect();
    urgent_ = !changed_.empty();
    publish_some();
  }

  static bool due(std::int64_t utime, std::int64_t& last, double period_s) {
    if (last != 0 && std::abs(static_cast<double>(utime - last)) < period_s * 1e6) return false;
    last = utime;
    return true;
  }

  void collect() {
    const auto changed = builder_.map().take_changed();
    if (changed.empty()) return;
    changed_.insert(changed.begin(), changed.end());
    ++version_;
  }

  void publish_some() {
    for (int k = 0; k < kTilesPerTick && !changed_.empty(); ++k) {
      publish(*changed_.begin());
      changed_.erase(changed_.begin());
    }
    urgent_ = urgent_ && !changed_.empty();
  }

  void publish(const OccupancyMap::TileIndex& index) {
    map_tile_t message{};
    message.utime = mirror_.nodes().empty() ? 0 : mirror_.nodes().back().utime;
    message.version = version_;
    message.epoch = mirror_.epoch();
    message.tile_x = index.first;
    message.tile_y = index.second;
    message.ncells = OccupancyMap::kTileCells;
    message.resolution_m = config_.resolution_m;
    message.encoding = map_tile_t::ZLIB;
    message.data = pack_cells(builder_.map().render(index));
    message.nbytes = static_cast<std::int32_t>(message.data.size());
    bus_.publish(channel::kMapTile, message);
  }

  Bus& bus_;
  MapBuilderConfig config_;
  MapBuilder builder_;
  GraphMirror mirror_;
  std::set<OccupancyMap::TileIndex> changed_;
  bool urgent_ = false;
  std::int64_t last_redraw_ = 0, last_publish_ = 0, version_ = 0, redrawn_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_map_builder(Bus& bus, const SystemConfig& config) {
  return std::make_unique<MapBuilderModule>(bus, config);
}

}  // namespace modslam
