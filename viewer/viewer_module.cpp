// SPDX-License-Identifier: BSD-3-Clause
#include <deque>
#include <modslam/loop_closure_t.hpp>
#include <modslam/scan_match_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"
#include "viewer/chunked_list.hpp"
#include "viewer/frames.hpp"
#include "viewer/trail.hpp"
#include "viewer/truth.hpp"
#include "viewer/web_server.hpp"

namespace modslam {
namespace {

using nlohmann::json;

constexpr std::size_t kScansKept = 40;       // an estimate comes at most this many sweeps later
constexpr std::size_t kMaxStreams = 50'000;  // tiles and processes that a page can be asked to hold
constexpr std::int64_t kClockEvery_us = 500'000;

/// Turns messages into the streams of the page. Things that come in lists or tiles go out as they
/// come; what moves goes out at rate_hz, newest only.
class ViewerModule : public Module {
 public:
  ViewerModule(Bus& bus, const ViewerConfig& config)
      : bus_(bus),
        flush_every_us_(static_cast<std::int64_t>(1e6 / config.rate_hz)),
        hub_(text_frame({{"stream", "hello"}, {"version", MODSLAM_VERSION}})),
        mirror_(bus),
        server_(static_cast<int>(config.port), hub_, web_files()) {
    listen_to_sensors();
    listen_to_graph();
    listen_to_maps();
  }

  void tick(std::int64_t steady_us) override {
    now_ms_ = steady_us / 1000;
    mirror_.tick(steady_us);
    if (steady_us - last_flush_us_ >= flush_every_us_) {
      last_flush_us_ = steady_us;
      flush();
    }
    if (steady_us - last_clock_us_ >= kClockEvery_us) {
      last_clock_us_ = steady_us;
      hub_.publish("clock", text_frame(clock_json()));
    }
  }

  void missed(const std::string& channel) override {
    if (channel == channel::kNode || channel == channel::kGraph || channel == channel::kMapTile || channel.rfind("SEMANTIC", 0) == 0)
      mirror_.suspect();  // whoever hears the question says tiles and lists again too
  }
  std::string words() const override {
    return "http://127.0.0.1:" + std::to_string(server_.port()) +
           "/, pages open: " + std::to_string(hub_.pages()) + ", " +
           std::to_string(mirror_.nodes().size()) + " nodes";
  }

 private:
  void listen_to_sensors() {
    bus_.subscribe<sensor_info_t>(channel::kSensorInfo,
                                  [this](const sensor_info_t& m) { sensor_ = to_sensor_info(m); });
    bus_.subscribe<bot_core::planar_lidar_t>(channel::kLaser,
                                             [this](const bot_core::planar_lidar_t& m) {
                                               scans_.push_back(to_scan(m));
                                               if (scans_.size() > kScansKept) scans_.pop_front();
                                               bus_.saw_utime(m.utime);
                                             });
    bus_.subscribe<bot_core::pose_t>(
        channel::kGroundTruth, [this](const bot_core::pose_t& m) { truth_.add(to_timed_pose(m)); });
  }

  void listen_to_graph() {
    mirror_.on_pose = [this](const pose_estimate_t& m) { take_pose(m); };
    mirror_.on_node = [this](const MirrorNode& node) { nodes_.append(node.T_map_base); };
    mirror_.on_update = [this](const std::vector<NodeId>& moved) {
      for (const NodeId id : moved)
        nodes_.set(static_cast<std::size_t>(id), mirror_.nodes()[id].T_map_base);
      edges_changed_ = true;
    };
    mirror_.on_reset = [this] { start_anew(); };
    bus_.subscribe<loop_closure_t>(channel::kLoop, [this](const loop_closure_t& m) {
      const bool accepted = m.verdict == scan_match_t::OK || m.verdict == scan_match_t::DEGENERATE;
      ++(accepted ? loops_proposed_ : loops_refused_);
    });
  }

  void listen_to_maps() {
    bus_.subscribe<map_tile_t>(channel::kMapTile, [this](const map_tile_t& m) {
      publish("tile/" + std::to_string(m.tile_x) + "/" + std::to_string(m.tile_y), tile_frame(m));
    });
    listen_to_list<wall_list_t>(channel::kWalls, "walls", walls_json);
    listen_to_list<room_list_t>(channel::kRooms, "rooms", rooms_json);
    listen_to_list<door_list_t>(channel::kDoors, "doors", doors_json);
    listen_to_list<object_list_t>(channel::kObjects, "objects", objects_json);
    bus_.subscribe<process_status_t>(channel::kStatus, [this](const process_status_t& m) {
      publish("status/" + m.name, text_frame(status_json(m, now_ms_)));
    });
  }

  template <class Message>
  void listen_to_list(const char* channel, const char* stream,
                      json (*to_json)(const std::vector<Message>&)) {
    auto list = std::make_shared<ChunkedList<Message>>();
    bus_.subscribe<Message>(channel, [this, channel, stream, to_json, list](const Message& m) {
      const std::int64_t incomplete = list->incomplete();
      const std::optional<std::vector<Message>> whole = list->add(m);
      if (list->incomplete() != incomplete) bus_.count_gap(channel, 1);
      if (whole) publish(stream, text_frame(to_json(*whole)));
    });
  }

  void publish(const std::string& stream, FramePtr frame) {
    if (hub_.streams() >= kMaxStreams)
      throw BadMessage("more than 50000 tiles and processes to show");
    hub_.publish(stream, std::move(frame));
  }

  void take_pose(const pose_estimate_t& message) {
    pose_frame_ = text_frame(pose_json(message));
    const Pose2 T_map_base = to_pose(message.T_map_base);
    pose_known_ = true;
    truth_.add_estimate(message.utime, T_map_base);
    for (const Scan& scan : scans_)
      if (scan.utime == message.utime) placed_scan_ = {scan, T_map_base};
  }

  void flush() {
    if (pose_frame_) hub_.publish("pose", std::exchange(pose_frame_, nullptr));
    // Without an estimator the robot is the middle of the map.
    if (!pose_known_ && !scans_.empty() && scans_.back().utime != shown_utime_)
      placed_scan_ = {scans_.back(), Pose2()};
    if (placed_scan_) {
      shown_utime_ = placed_scan_->first.utime;
      hub_.publish("scan",
                   text_frame(scan_json(placed_scan_->first, sensor_, placed_scan_->second)));
      placed_scan_.reset();
    }
    nodes_.flush(hub_);
    truth_.flush(hub_);
    if (std::exchange(edges_changed_, false)) hub_.publish("edges", text_frame(edges_json()));
  }

  json edges_json() const {
    json loops = json::array();
    for (const auto& [id, edge] : mirror_.edges())
      if (edge.kind == EdgeKind::kLoop) loops.push_back({edge.from, edge.to});
    return {{"stream", "edges"}, {"loops", std::move(loops)}, {"epoch", mirror_.epoch()}};
  }

  json clock_json() const {
    json channels = json::array();
    for (const auto& [name, count] : bus_.inputs())
      channels.push_back({{"channel", name},
                          {"received", count.received},
                          {"bad", count.bad},
                          {"gaps", count.gaps}});
    return {{"stream", "clock"},
            {"now_ms", now_ms_},
            {"utime", bus_.utime()},
            {"channels", std::move(channels)},
            {"nodes", mirror_.nodes().size()},
            {"complete", mirror_.complete()},
            {"loops_proposed", loops_proposed_},
            {"loops_refused", loops_refused_}};
  }

  /// Another session's graph has begun: what was shown of the old one would lie.
  void start_anew() {
    hub_.restart("status/");
    nodes_.clear();
    truth_.clear();
    scans_.clear();
    pose_frame_ = nullptr;
    placed_scan_.reset();
    pose_known_ = edges_changed_ = false;
    loops_proposed_ = loops_refused_ = 0;
  }

  Bus& bus_;
  std::int64_t flush_every_us_;
  Hub hub_;
  GraphMirror mirror_;
  Trail nodes_{"nodes"};
  Truth truth_;
  SensorInfo sensor_;
  std::deque<Scan> scans_;  ///< newest last
  std::optional<std::pair<Scan, Pose2>> placed_scan_;
  FramePtr pose_frame_;
  bool pose_known_ = false, edges_changed_ = false;
  std::int64_t loops_proposed_ = 0, loops_refused_ = 0, shown_utime_ = 0;
  std::int64_t now_ms_ = 0, last_flush_us_ = 0, last_clock_us_ = 0;
  WebServer server_;  ///< last: its threads must end before what they read
};

}  // namespace

std::unique_ptr<Module> make_viewer(Bus& bus, const SystemConfig& config) {
  return std::make_unique<ViewerModule>(bus, config.viewer);
}

}  // namespace modslam
