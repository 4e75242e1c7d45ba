// SPDX-License-Identifier: BSD-3-Clause
/// procs/semantic_classifier — NODE + GRAPH (+ POSE, SYNC_REQUEST) → SEMANTIC_WALLS, _ROOMS, _DOORS, _OBJECTS, _PLACES; QUERY → ANSWER.
/// Config: [semantics], [places].
#include <iostream>
#include <map>
#include <opencv2/core/utility.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/semantic_messages.hpp"
#include "common/bus/system_config.hpp"
#include "common/bus/topology_messages.hpp"
#include "common/formats/file_bytes.hpp"
#include "common/places/place_mapper.hpp"
#include "common/semantics/place_hints.hpp"
#include "common/semantics/semantic_mapper.hpp"

namespace modslam {
namespace {

/// @param trouble  why there is none, when one was asked for
std::optional<PlaceModel> load_places(const std::string& path, std::string& trouble) {
  if (path.empty()) return std::nullopt;
  try {
    return PlaceModel::parse(read_file_bytes(path).bytes);
  } catch (const std::runtime_error& error) {
    const std::string why = error.what();
    trouble = "no places: " + (why.rfind(path, 0) == 0 ? why : path + ": " + why) + "; ./run.sh train places makes it";
    std::cerr << "semantic_classifier: " << trouble << std::endl;
    return std::nullopt;
  }
}

class SemanticClassifierModule : public Module {
 public:
  SemanticClassifierModule(Bus& bus, const SystemConfig& config)
      : bus_(bus), config_(config.semantics), mapper_(config.semantics), places_(load_places(config.places.model, trouble_)), mirror_(bus) {
    mirror_.on_node = [this](const MirrorNode& node) {
      mapper_.add_node(node.scan, node.sensor, node.T_map_base);
      places_.add_node(node.scan, node.sensor, node.T_map_base);
      dirty_ = true;
    };
    mirror_.on_update = [this](const std::vector<NodeId>& moved) {
      for (const NodeId id : moved) mapper_.set_pose(id, mirror_.nodes()[static_cast<std::size_t>(id)].T_map_base);
      dirty_ = dirty_ || !moved.empty();
      if (dirty_ && !mirror_.nodes().empty() && due(mirror_.nodes().back().utime)) work(false);
    };
    mirror_.on_reset = [this] {
      mapper_.clear();
      places_.clear();
      layers_ = {};
      topology_.reset();
      first_seen_.clear();
      last_ = 0;
    };
    bus.subscribe<sync_request_t>(channel::kSyncRequest, [this](const sync_request_t& m) {
      if (m.requester != bus_.name() && version_ > 0) publish();
    });
    bus.subscribe<query_t>(channel::kQuery, [this](const query_t& m) { bus_.publish(channel::kAnswer, answer(topology(), m, bus_.utime())); });
  }

  void finish() override {
    if (!mirror_.nodes().empty()) work(true);
  }

  void tick(std::int64_t steady_us) override { mirror_.tick(steady_us); }
  bool complete() const override { return mirror_.settled(); }
  void missed(const std::string& channel) override {
    if (channel == channel::kNode || channel == channel::kGraph) mirror_.suspect();
  }
  std::string words() const override {
    return std::to_string(layers_.walls.size()) + " walls, " + std::to_string(layers_.rooms.size()) + " rooms, " +
           std::to_string(layers_.doors.size()) + " doors, " + std::to_string(layers_.objects.size()) + " objects, of " +
           std::to_string(mirror_.nodes().size()) + " nodes" + (trouble_.empty() ? "" : "; " + trouble_);
  }

 private:
  bool due(std::int64_t utime) {
    if (last_ != 0 && std::abs(static_cast<double>(utime - last_)) < config_.publish_s * 1e6) return false;
    last_ = utime;
    return true;
  }

  void work(bool settled) {
    dirty_ = false;
    layers_ = mapper_.update(settled);
    const PlaceHints map(layers_);
    std::vector<PlaceOnMap> on_map;
    for (const MirrorNode& node : mirror_.nodes()) on_map.push_back(map.at(node.T_map_base.translation()));
    layers_.places = places_.places(on_map);
    topology_.reset();
    ++version_;
    publish();
  }

  /// Worked out when somebody asks.
  const Topology& topology() {
    if (!topology_) {
      std::vector<Eigen::Vector2d> path;
      for (const MirrorNode& node : mirror_.nodes()) path.push_back(node.T_map_base.translation());
      topology_ = build_topology(layers_, path);
    }
    return *topology_;
  }

  void publish() {
    const std::int64_t utime = mirror_.nodes().back().utime;
    std::vector<wall_t> walls;
    for (const Wall& wall : layers_.walls) walls.push_back(to_message(wall));
    std::vector<room_t> rooms;
    for (const Room& room : layers_.rooms) rooms.push_back(to_message(room));
    std::vector<door_t> doors;
    for (const Door& door : layers_.doors) doors.push_back(to_message(door));
    std::vector<object_t> objects;
    for (const Object& object : layers_.objects) {
      objects.push_back(to_message(object, utime));
      objects.back().first_utime = first_seen_.emplace(object.id, utime).first->second;
    }
    for (const auto& m : to_chunks<wall_list_t>(walls, utime, version_, [](wall_list_t& list, const std::vector<wall_t>& part) {
           list.walls = part;
           list.nwalls = static_cast<std::int32_t>(part.size());
         }))
      bus_.publish(channel::kWalls, m);
    for (const auto& m : to_chunks<room_list_t>(rooms, utime, version_, [this](room_list_t& list, const std::vector<room_t>& part) {
           list.rooms = part;
           list.nrooms = static_cast<std::int32_t>(part.size());
           if (list.chunk > 0) return;
           for (const RoomEvent& event : layers_.room_events) list.events.push_back(to_message(event));
           list.nevents = static_cast<std::int32_t>(list.events.size());
         }))
      bus_.publish(channel::kRooms, m);
    for (const auto& m : to_chunks<door_list_t>(doors, utime, version_, [](door_list_t& list, const std::vector<door_t>& part) {
           list.doors = part;
           list.ndoors = static_cast<std::int32_t>(part.size());
         }))
      bus_.publish(channel::kDoors, m);
    for (const auto& m : to_chunks<object_list_t>(objects, utime, version_, [](object_list_t& list, const std::vector<object_t>& part) {
           list.objects = part;
           list.nobjects = static_cast<std::int32_t>(part.size());
         }))
      bus_.publish(channel::kObjects, m);
    for (const auto& m : to_place_chunks(layers_.places, utime, version_)) bus_.publish(channel::kPlaces, m);
  }

  Bus& bus_;
  SemanticsConfig config_;
  std::string trouble_;
  SemanticMapper mapper_;
  PlaceMapper places_;
  GraphMirror mirror_;
  SemanticLayers layers_;
  std::optional<Topology> topology_;
  std::map<std::int64_t, std::int64_t> first_seen_;  ///< utime of the version that an object came with, by its id
  bool dirty_ = false;
  std::int64_t last_ = 0, version_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_semantic_classifier(Bus& bus, const SystemConfig& config) {
  cv::setNumThreads(1);  // its pictures are small; waking other cores for them costs more than it saves
  return std::make_unique<SemanticClassifierModule>(bus, config);
}

}  // namespace modslam
