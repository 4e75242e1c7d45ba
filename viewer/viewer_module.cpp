// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <deque>
#include <modslam/command_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <modslam/playback_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/graph_mirror.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"
#include "viewer/chunked_list.hpp"
#include "viewer/events.hpp"
#include "viewer/frames.hpp"
#include "viewer/loop_book.hpp"
#include "viewer/series.hpp"
#include "viewer/trail.hpp"
#include "viewer/truth.hpp"
#include "viewer/verdict.hpp"
#include "viewer/web_server.hpp"

namespace modslam {
namespace {

using nlohmann::json;

constexpr std::size_t kScansKept = 40;       // an estimate comes at most this many sweeps later
constexpr std::size_t kMaxStreams = 50'000;  // tiles and processes that a page can be asked to hold
constexpr std::int64_t kClockEvery_us = 500'000, kSeriesEvery_us = 1'000'000;

std::string secret_of_environment() {
  const char* token = std::getenv("MODSLAM_TOKEN");
  return token ? token : "";
}

/// Turns messages into the streams of the page. Things that come in lists or tiles go out as they
/// come; what moves goes out at rate_hz, newest only; lists of loops, events and figures more
/// seldom.
class ViewerModule : public Module {
 public:
  ViewerModule(Bus& bus, const ViewerConfig& config)
      : bus_(bus),
        host_(config.host),
        flush_every_us_(static_cast<std::int64_t>(1e6 / config.rate_hz)),
        hub_(text_frame({{"stream", "hello"}, {"version", MODSLAM_VERSION}}),
             static_cast<std::size_t>(config.history_mb) << 20),
        mirror_(bus, GraphMirror::kDropScans),
        server_(config.host, static_cast<int>(config.port),
                Gate(config.host, secret_of_environment()), hub_, wishes_, web_files()) {
    listen_to_sensors();
    listen_to_graph();
    listen_to_maps();
    listen_to_processes();
  }

  void tick(std::int64_t steady_us) override {
    now_ms_ = steady_us / 1000;
    mirror_.tick(steady_us);
    send_wishes();
    if (steady_us - last_flush_us_ >= flush_every_us_) {
      last_flush_us_ = steady_us;
      flush();
    }
    if (steady_us - last_clock_us_ >= kClockEvery_us) {
      last_clock_us_ = steady_us;
      flush_lists();
      hub_.publish("clock", text_frame(clock_json()));
    }
    if (steady_us - last_series_us_ >= kSeriesEvery_us) {
      last_series_us_ = steady_us;
      json series = series_.to_json();
      series["stream"] = "series";
      hub_.publish("series", text_frame(series));
    }
  }

  void missed(const std::string& channel) override {
    if (channel == channel::kNode || channel == channel::kGraph || channel == channel::kMapTile || channel.rfind("SEMANTIC", 0) == 0)
      mirror_.suspect();  // whoever hears the question says tiles and lists again too
  }
  std::string words() const override {
    return "http://" + host_ + ":" + std::to_string(server_.port()) +
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
                                               saw(m.utime);
                                             });
    bus_.subscribe<bot_core::pose_t>(
        channel::kGroundTruth, [this](const bot_core::pose_t& m) { truth_.add(to_timed_pose(m)); });
  }

  void listen_to_graph() {
    mirror_.on_pose = [this](const pose_estimate_t& m) { take_pose(m); };
    mirror_.on_node = [this](const MirrorNode& node) { nodes_.append(triple(node.T_map_base)); };
    mirror_.on_update = [this](const std::vector<NodeId>& moved) {
      for (const NodeId id : moved) {
        const auto index = static_cast<std::size_t>(id);
        nodes_.set(index, triple(mirror_.nodes()[index].T_map_base));
      }
      edges_changed_ = true;
    };
    mirror_.on_reset = [this] { start_anew(); };
    bus_.subscribe<loop_closure_t>(channel::kLoop, [this](const loop_closure_t& m) {
      loops_.propose(m);
      proposals_changed_ = true;
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
    listen_to_list<place_list_t>(channel::kPlaces, "places", places_json);
  }

  void listen_to_processes() {
    bus_.subscribe<process_status_t>(channel::kStatus, [this](const process_status_t& m) {
      require_room();
      hub_.publish("status/" + m.name, text_frame(status_json(m, now_ms_)));
      events_.see_status(run_utime_, m);
      take_figures(m);
    });
    bus_.subscribe<playback_t>(channel::kPlayback, [this](const playback_t& m) {
      hub_.publish("playback", text_frame(playback_json(m, now_ms_)));
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
      if (!whole) return;
      const json content = to_json(*whole);
      publish(stream, text_frame(content));
      if (std::string(stream) == "rooms" || std::string(stream) == "doors")
        events_.see_list(run_utime_, stream, content.at("items"));
    });
  }

  void require_room() const {
    if (hub_.streams() >= kMaxStreams)
      throw BadMessage("more than 50000 tiles and processes to show");
  }
  void publish(const std::string& stream, FramePtr frame) {
    require_room();
    hub_.publish_kept(stream, run_utime_, std::move(frame));
  }

  /// The run's time: the newest stamp of this session, which may lie before the one of a session
  /// that ended.
  void saw(std::int64_t utime) {
    run_utime_ = std::max(run_utime_, utime);
    bus_.saw_utime(utime);
  }

  void take_pose(const pose_estimate_t& message) {
    json frame = pose_json(message);
    const Pose2 T_map_base = to_pose(message.T_map_base);
    const auto sigmas = ellipse(to_matrix(message.covariance));
    saw(message.utime);
    pose_known_ = true;
    const std::optional<double> error_m = truth_.add_estimate(message.utime, T_map_base);
    if (error_m) frame["error_m"] = *error_m;
    pose_frame_ = text_frame(frame);
    for (const Scan& scan : scans_)
      if (scan.utime == message.utime) placed_scan_ = {scan, T_map_base};
    take_ellipse(message.node_id, sigmas);
    events_.see_pose(message);
    if (error_m) series_.add(message.utime, Series::kError_m, *error_m);
    series_.add(message.utime, Series::kSigma_m, std::hypot(sigmas[0], sigmas[1]));
    const bool good = is_good(message.verdict), half = message.verdict == scan_match_t::DEGENERATE;
    series_.add(message.utime, Series::kOk, good);
    series_.add(message.utime, Series::kDegenerate, half);
    series_.add(message.utime, Series::kBad, !good && !half);
  }

  /// A node's ellipse is the pose's when the node was new: the graph itself does not tell of it.
  void take_ellipse(NodeId node, const Triple& sigmas) {
    if (node < 0 || node >= static_cast<NodeId>(mirror_.nodes().size())) return;
    const auto index = static_cast<std::size_t>(node);
    while (ellipses_.triples().size() < index) ellipses_.append({});  // came before this viewer
    if (ellipses_.triples().size() == index) ellipses_.append(sigmas);
  }

  /// What is known to be missing on the bus, and how long the slowest process takes.
  void take_figures(const process_status_t& m) {
    std::int64_t missing = 0;
    for (const channel_count_t& input : m.inputs) missing += input.gaps + input.bad;
    const std::int64_t before = std::exchange(missing_[m.name], missing);
    missing_total_ += std::max<std::int64_t>(0, missing - before);
    if (!run_utime_) return;
    series_.add(run_utime_, Series::kMissing, static_cast<double>(missing_total_));
    if (m.name == "scan_matcher")
      series_.add(run_utime_, Series::kLatency_ms, static_cast<double>(m.latency_p99_us) / 1000);
  }

  void send_wishes() {
    while (const std::optional<std::string> wish = wishes_.take()) {
      command_t command{};
      command.utime = run_utime_;
      command.target = "player";
      command.verb = *wish;
      bus_.publish(channel::kPlaybackCommand, command);
    }
  }

  void flush() {
    if (pose_frame_) hub_.publish_kept("pose", run_utime_, std::exchange(pose_frame_, nullptr));
    // Without an estimator the robot is the middle of the map.
    if (!pose_known_ && !scans_.empty() && scans_.back().utime != shown_utime_)
      placed_scan_ = {scans_.back(), Pose2()};
    if (placed_scan_) {
      shown_utime_ = placed_scan_->first.utime;
      hub_.publish_kept("scan", run_utime_,
                        text_frame(scan_json(placed_scan_->first, sensor_, placed_scan_->second)));
      placed_scan_.reset();
    }
    nodes_.flush(hub_, run_utime_);
    ellipses_.flush(hub_, run_utime_);
    truth_.flush(hub_, run_utime_);
  }

  void flush_lists() {
    if (std::exchange(edges_changed_, false)) {
      const LoopBook::Change change = loops_.see_edges(mirror_.edges());
      const auto say = [this](const char* what, const LoopBook::Pair& pair) {
        events_.say(
            run_utime_, "loop",
            std::string(what) + std::to_string(pair.first) + " – " + std::to_string(pair.second));
      };
      for (const auto& pair : change.closed) say("loop closed: nodes ", pair);
      for (const auto& pair : change.retracted) say("loop taken back: nodes ", pair);
      if (!change.closed.empty() || !change.retracted.empty())
        hub_.publish_kept("edges", run_utime_, text_frame(loops_.edges_json(mirror_.epoch())));
    }
    if (std::exchange(proposals_changed_, false))
      hub_.publish_kept("proposals", run_utime_, text_frame(loops_.proposals_json()));
    if (events_.take_changed()) hub_.publish("events", text_frame(events_.to_json()));
  }

  json clock_json() const {
    const History::Extent past = hub_.history().extent();
    return {{"stream", "clock"},
            {"now_ms", now_ms_},
            {"utime", run_utime_},
            {"past", {past.begin_utime, past.end_utime}},
            {"past_step_us", past.interval_us},
            {"channels", counts_json(bus_.inputs())},
            {"nodes", mirror_.nodes().size()},
            {"complete", mirror_.complete()},
            {"loops_proposed", loops_.proposed()},
            {"loops_refused", loops_.refused()}};
  }

  /// Another session's graph has begun: what was shown of the old one would lie.
  void start_anew() {
    hub_.restart("status/");
    for (Trail* trail : {&nodes_, &ellipses_}) trail->clear();
    truth_.clear();
    scans_.clear();
    loops_.clear();
    events_.forget_map();
    series_.clear();
    pose_frame_ = nullptr;
    placed_scan_.reset();
    pose_known_ = edges_changed_ = proposals_changed_ = false;
    run_utime_ = 0;
  }

  Bus& bus_;
  std::string host_;
  std::int64_t flush_every_us_;
  Hub hub_;
  Wishes wishes_;
  GraphMirror mirror_;
  Trail nodes_{"nodes"}, ellipses_{"ellipses"};
  Truth truth_;
  LoopBook loops_;
  Events events_;
  Series series_;
  SensorInfo sensor_;
  std::deque<Scan> scans_;  ///< newest last
  std::optional<std::pair<Scan, Pose2>> placed_scan_;
  FramePtr pose_frame_;
  bool pose_known_ = false, edges_changed_ = false, proposals_changed_ = false;
  std::map<std::string, std::int64_t> missing_;
  std::int64_t missing_total_ = 0, shown_utime_ = 0, run_utime_ = 0;
  std::int64_t now_ms_ = 0, last_flush_us_ = 0, last_clock_us_ = 0, last_series_us_ = 0;
  WebServer server_;  ///< last: its threads must end before what they read
};

}  // namespace

std::unique_ptr<Module> make_viewer(Bus& bus, const SystemConfig& config) {
  return std::make_unique<ViewerModule>(bus, config.viewer);
}

}  // namespace modslam
