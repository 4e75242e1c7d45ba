// SPDX-License-Identifier: BSD-3-Clause
/// publish_sample [--url URL] [--speed X]: plays a made-up run to the viewer and to lcm-spy. It is
/// told what to do line by line on its input: "silence NAME", "speak NAME", "trouble NAME", "quit".
/// It prints "ready" when it has begun.
#include <poll.h>
#include <unistd.h>
#include <zlib.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <modslam/door_list_t.hpp>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <modslam/map_tile_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/process_status_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/sync_request_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <sstream>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/semantic_messages.hpp"
#include "tests/viewer/sample_building.hpp"

namespace modslam::sample {
namespace {

constexpr double kStep_s = 0.1, kSpeed_mps = 1.0, kNodeEvery_m = 0.5;
constexpr int kBeams = 361;

template <class List, class Item>
void finish_list(List& list, std::int64_t utime, std::int64_t version, std::int32_t List::*count,
                 const std::vector<Item>& items) {
  list.utime = utime;
  list.version = version;
  list.nchunks = 1;
  list.*count = static_cast<std::int32_t>(items.size());
}

class Player {
 public:
  explicit Player(const std::string& url) : transport_(url), bus_(transport_, "sample") {
    bus_.subscribe<sync_request_t>(channel::kSyncRequest, [this](const sync_request_t& m) {
      for (std::size_t i = static_cast<std::size_t>(std::max<std::int64_t>(0, m.from_node));
           i < nodes_.size(); ++i)
        bus_.publish(channel::kNode, nodes_[i]);
      if (!nodes_.empty()) publish_graph(true);
      grid_.mark_all_changed();
    });
  }

  /// One tenth of a second of the run.
  void step() {
    utime_ += static_cast<std::int64_t>(kStep_s * 1e6);
    ++steps_;
    way_m_ += kSpeed_mps * kStep_s;
    const Pose2 truth = on_route(way_m_);
    publish_truth(truth);
    const Scan scan = sweep(truth);
    bus_.publish(channel::kLaser, to_message(scan));
    if (steps_ % 50 == 1) bus_.publish(channel::kSensorInfo, to_message(sensor(), utime_));
    const Pose2 estimate{truth.x + 0.06 * std::sin(0.05 * way_m_),
                         truth.y + 0.05 * std::sin(0.08 * way_m_), truth.heading};
    if (nodes_.empty() || way_m_ - last_node_m_ >= kNodeEvery_m) add_node(estimate, scan);
    publish_pose(estimate);
    if (steps_ % 10 == 0) publish_maps(truth);
  }

  void publish_statuses() {
    for (const char* name : {"laser", "odometry", "scan_matcher", "graph_optimizer",
                             "loop_detector", "map_builder", "semantic_classifier"}) {
      if (silent_.count(name)) continue;
      process_status_t m{};
      m.utime = utime_;
      m.name = name;
      m.version = MODSLAM_VERSION;
      m.pid = getpid();
      m.state = troubled_.count(name) ? process_status_t::TROUBLED : process_status_t::RUNNING;
      m.words = troubled_.count(name) ? "something is not as it should be" : std::string();
      m.latency_p50_us = 1200;
      m.latency_p99_us = 4800;
      m.memory_kb = 41'000;
      bus_.publish(channel::kStatus, m);
    }
  }

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string verb, name;
    words >> verb >> name;
    if (verb == "silence") silent_.insert(name);
    if (verb == "speak") silent_.erase(name), troubled_.erase(name);
    if (verb == "trouble") troubled_.insert(name);
    if (verb == "quit") running_ = false;
  }
  bool running() const { return running_; }
  void listen(int timeout_ms) { transport_.poll(timeout_ms); }

 private:
  static SensorInfo sensor() {
    SensorInfo s;
    s.range_max_m = 20;
    return s;
  }

  Scan sweep(const Pose2& truth) {
    Scan scan;
    scan.utime = utime_;
    scan.rad0 = -kPi;
    scan.radstep = 2 * kPi / (kBeams - 1);
    for (int i = 0; i < kBeams; ++i) {
      const double angle = truth.heading + scan.bearing_rad(static_cast<std::size_t>(i));
      const auto [range_m, hit] = cast_ray(truth.x, truth.y, angle);
      const bool missing = !(range_m < sensor().range_max_m);
      scan.ranges_m.push_back(missing ? 0.0F : static_cast<float>(range_m));
      if (missing) continue;
      if (hit < kWalls.size()) ++hits_[hit];
      grid_.add_beam(truth.x, truth.y, angle, range_m);
    }
    return scan;
  }

  /// The truth speaks of its own frame, turned against the map.
  void publish_truth(const Pose2& truth) {
    TimedPose timed;
    timed.utime = utime_;
    timed.pose = Pose2(40, -7, 0.7) * truth;
    bus_.publish(channel::kGroundTruth, to_message(timed));
  }

  void publish_pose(const Pose2& estimate) {
    pose_estimate_t m{};
    m.utime = utime_;
    m.seq = seq_++;
    put(m.T_map_base, estimate);
    m.covariance[0] = 0.004;
    m.covariance[1] = m.covariance[3] = 0.001;
    m.covariance[4] = 0.002;
    m.covariance[8] = 0.0004;
    m.verdict = scan_match_t::OK;
    m.node_id = static_cast<std::int64_t>(nodes_.size()) - 1;
    m.node_before = -1;
    bus_.publish(channel::kPose, m);
  }

  void add_node(const Pose2& estimate, const Scan& scan) {
    last_node_m_ = way_m_;
    graph_node_t node{};
    node.utime = utime_;
    node.id = static_cast<std::int64_t>(nodes_.size());
    put(node.T_map_base, estimate);
    node.sensor = to_message(sensor(), utime_);
    node.scan = to_message(scan);
    nodes_.push_back(node);
    new_edges_.clear();
    if (node.id > 0) add_edge(node.id - 1, node.id, graph_edge_t::SEQUENCE);
    for (std::int64_t old = 0; old + 12 < node.id && node.id % 4 == 0; ++old) {
      const Pose2 there = to_pose(nodes_[static_cast<std::size_t>(old)].T_map_base);
      if (distance(there, estimate) > 0.3) continue;
      add_edge(old, node.id, graph_edge_t::LOOP);
      loop_closure_t loop{};
      loop.utime = utime_;
      loop.seq = ++loop_seq_;
      loop.from_node = old;
      loop.to_node = node.id;
      loop.verdict = loop_seq_ % 3 == 0 ? scan_match_t::AMBIGUOUS : scan_match_t::OK;
      bus_.publish(channel::kLoop, loop);
      break;
    }
    bus_.publish(channel::kNode, node);
    publish_graph(false);
  }

  void add_edge(std::int64_t from, std::int64_t to, std::int8_t kind) {
    graph_edge_t edge{};
    edge.id = static_cast<std::int64_t>(edges_.size());
    edge.from_node = from;
    edge.to_node = to;
    edge.kind = kind;
    edge.information[0] = edge.information[3] = edge.information[5] = 100;
    edges_.push_back(edge);
    new_edges_.push_back(edge);
  }

  void publish_graph(bool snapshot) {
    graph_update_t m{};
    m.utime = utime_;
    m.seq = snapshot ? graph_seq_ : ++graph_seq_;
    m.snapshot = snapshot;
    m.nchunks = 1;
    m.nnodes = static_cast<std::int64_t>(nodes_.size());
    m.edges = snapshot ? edges_ : new_edges_;
    m.nedges = static_cast<std::int32_t>(m.edges.size());
    bus_.publish(channel::kGraph, m);
  }

  void publish_maps(const Pose2& truth) {
    ++version_;
    for (const auto& key : grid_.take_changed()) publish_tile(key);
    for (std::size_t i = 0; i < kRooms.size(); ++i) {
      const Room& r = kRooms[i];
      if (truth.x > r.x0 + 0.5 && truth.x < r.x1 - 0.5 && truth.y > r.y0 + 0.5 &&
          truth.y < r.y1 - 0.5)
        seen_rooms_.insert(i);
    }
    publish_walls();
    publish_rooms();
    publish_doors();
    publish_objects();
    publish_places();
  }

  void publish_places() {
    std::vector<Place> places;
    for (const graph_node_t& node : nodes_) {
      Place place;
      place.node = node.id;
      place.confidence = 0.9;
      const double x = node.T_map_base[0], y = node.T_map_base[1];
      if (y > 0 && y < 2) place.kind = PlaceKind::kCorridor;
      for (const Door& door : kDoors)
        if (std::hypot(x - (door.opening.ax + door.opening.bx) / 2,
                       y - (door.opening.ay + door.opening.by) / 2) < 0.5)
          place.kind = PlaceKind::kDoorway;
      places.push_back(place);
    }
    for (const place_list_t& m : to_place_chunks(places, utime_, version_)) bus_.publish(channel::kPlaces, m);
  }

  void publish_tile(const TiledGrid::Key& key) {
    const std::vector<std::uint8_t> cells = grid_.bytes(key);
    map_tile_t m{};
    m.utime = utime_;
    m.version = version_;
    m.tile_x = key.first;
    m.tile_y = key.second;
    m.ncells = TiledGrid::kCells;
    m.resolution_m = TiledGrid::kResolution_m;
    m.encoding = map_tile_t::ZLIB;
    uLongf size = compressBound(cells.size());
    m.data.resize(size);
    compress2(m.data.data(), &size, cells.data(), cells.size(), 6);
    m.data.resize(size);
    m.nbytes = static_cast<std::int32_t>(size);
    bus_.publish(channel::kMapTile, m);
  }

  void publish_walls() {
    wall_list_t list{};
    for (std::size_t i = 0; i < kWalls.size(); ++i) {
      if (hits_[i] < 60) continue;
      wall_t w{};
      w.id = static_cast<std::int64_t>(i) + 1;
      w.a[0] = kWalls[i].ax, w.a[1] = kWalls[i].ay, w.b[0] = kWalls[i].bx, w.b[1] = kWalls[i].by;
      w.evidence = std::min(6.0, 0.01 * hits_[i]);
      w.sigma_m = 0.012;
      list.walls.push_back(w);
    }
    finish_list(list, utime_, version_, &wall_list_t::nwalls, list.walls);
    bus_.publish(channel::kWalls, list);
  }

  void publish_rooms() {
    room_list_t list{};
    for (const std::size_t i : seen_rooms_) {
      const Room& from = kRooms[i];
      room_t r{};
      r.id = static_cast<std::int64_t>(i) + 1;
      r.name = from.name;
      r.type = from.corridor ? room_t::CORRIDOR : room_t::ROOM;
      r.area_m2 = (from.x1 - from.x0) * (from.y1 - from.y0);
      r.explored = 0.97;
      r.evidence = 3.1;
      r.x = {from.x0, from.x1, from.x1, from.x0};
      r.y = {from.y0, from.y0, from.y1, from.y1};
      r.npoints = 4;
      list.rooms.push_back(r);
    }
    finish_list(list, utime_, version_, &room_list_t::nrooms, list.rooms);
    bus_.publish(channel::kRooms, list);
  }

  void publish_doors() {
    door_list_t list{};
    for (std::size_t i = 0; i < kDoors.size(); ++i) {
      const Door& from = kDoors[i];
      if (!seen_rooms_.count(static_cast<std::size_t>(from.room_a - 1))) continue;
      door_t d{};
      d.id = static_cast<std::int64_t>(i) + 1;
      d.a[0] = from.opening.ax, d.a[1] = from.opening.ay, d.b[0] = from.opening.bx,
      d.b[1] = from.opening.by;
      d.width_m = std::hypot(d.b[0] - d.a[0], d.b[1] - d.a[1]);
      d.evidence = 2.2;
      d.room_a = from.room_a;
      d.room_b = from.room_b;
      d.state = from.open ? door_t::OPEN : door_t::CLOSED;
      list.doors.push_back(d);
    }
    finish_list(list, utime_, version_, &door_list_t::ndoors, list.doors);
    bus_.publish(channel::kDoors, list);
  }

  void publish_objects() {
    object_list_t list{};
    for (std::size_t i = 0; i < kTables.size(); ++i) {
      if (!seen_rooms_.count(i == 0 ? 0 : 4)) continue;
      const auto& [x0, y0, x1, y1] = kTables[i];
      object_t o{};
      o.id = static_cast<std::int64_t>(i) + 1;
      o.class_name = i == 0 ? "table" : "";
      o.area_m2 = (x1 - x0) * (y1 - y0);
      o.evidence = 1.4;
      o.first_utime = utime_ - 4'000'000;
      o.last_utime = utime_;
      o.x = {x0, x1, x1, x0};
      o.y = {y0, y0, y1, y1};
      o.npoints = 4;
      list.objects.push_back(o);
    }
    finish_list(list, utime_, version_, &object_list_t::nobjects, list.objects);
    bus_.publish(channel::kObjects, list);
  }

  Transport transport_;
  Bus bus_;
  bool running_ = true;
  std::set<std::string> silent_, troubled_;
  std::int64_t utime_ = 1'000'000'000, steps_ = 0, seq_ = 0, graph_seq_ = 0, loop_seq_ = 0,
               version_ = 0;
  double way_m_ = 0, last_node_m_ = 0;
  std::vector<graph_node_t> nodes_;
  std::vector<graph_edge_t> edges_, new_edges_;
  std::map<std::size_t, int> hits_;
  std::set<std::size_t> seen_rooms_;
  TiledGrid grid_;
};

void obey_input(Player& player) {
  static std::string line;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char c = 0;
  while (::poll(&input, 1, 0) == 1 && read(STDIN_FILENO, &c, 1) == 1) {
    if (c != '\n')
      line += c;
    else
      player.obey(std::exchange(line, {}));
  }
}

}  // namespace
}  // namespace modslam::sample

int main(int argc, char** argv) {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  double speed = 1.0;
  CLI::App app("Plays a made-up run on the bus, for tests of the viewer and of spy.");
  app.add_option("--url", url, "LCM url")->capture_default_str();
  app.add_option("--speed", speed, "simulated seconds a second")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 50.0));
  CLI11_PARSE(app, argc, argv);

  using Clock = std::chrono::steady_clock;
  modslam::sample::Player player(url);
  Clock::time_point next_step = Clock::now(), next_status = next_step;
  std::cout << "ready" << std::endl;
  while (player.running()) {
    obey_input(player);
    if (Clock::now() >= next_step) {
      next_step +=
          std::chrono::microseconds(static_cast<int>(1e6 * modslam::sample::kStep_s / speed));
      player.step();
    }
    if (Clock::now() >= next_status) {
      next_status += std::chrono::seconds(1);
      player.publish_statuses();
    }
    player.listen(5);
  }
  return 0;
}
