// SPDX-License-Identifier: BSD-3-Clause
/// publish_big [--url URL] [--nodes N] [--rooms M]: a generated building with a graph of N nodes
/// and M rooms, then a robot that drives on in it with 40 scans a second. Prints "ready" when all
/// of it has been said once.
#include <zlib.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/map_tile_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"

namespace modslam {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kRoom_m = 6.0;
constexpr int kBeams = 1081, kScans_hz = 40;

/// Rooms stand in a square; the robot passes all of them, row by row, back and forth.
class BigBuilding {
 public:
  BigBuilding(const std::string& url, int nodes, int rooms)
      : transport_(url),
        bus_(transport_, "big"),
        nodes_(nodes),
        rooms_(rooms),
        side_(static_cast<int>(std::ceil(std::sqrt(rooms)))) {}

  void say_all() {
    publish_tiles();
    publish_walls();
    publish_rooms();
    for (int id = 0; id < nodes_; ++id) publish_node(id);
    publish_graph();
  }

  /// One scan; a loop moves a thousand nodes every five seconds.
  void step() {
    ++steps_;
    utime_ += 1'000'000 / kScans_hz;
    const Pose2 pose = on_way(0.3 * nodes_ + 0.02 * static_cast<double>(steps_));
    bus_.publish(channel::kLaser, to_message(sweep()));
    pose_estimate_t m{};
    m.utime = utime_;
    m.seq = steps_;
    put(m.T_map_base, pose);
    m.covariance[0] = m.covariance[4] = 1e-4;
    m.covariance[8] = 1e-5;
    m.verdict = scan_match_t::OK;
    m.node_id = nodes_ - 1;
    m.node_before = -1;
    bus_.publish(channel::kPose, m);
    if (steps_ % (5 * kScans_hz) == 0) move_nodes();
  }

 private:
  Pose2 on_way(double way_m) const {
    const double row_m = side_ * kRoom_m;
    const double along_m = std::fmod(way_m, row_m);
    const int row = static_cast<int>(way_m / row_m) % side_;
    const bool back = row % 2 == 1;
    return {back ? row_m - along_m : along_m, (row + 0.5) * kRoom_m, back ? kPi : 0.0};
  }

  Scan sweep() const {
    Scan scan;
    scan.utime = utime_;
    scan.rad0 = -0.75 * kPi;
    scan.radstep = 1.5 * kPi / (kBeams - 1);
    for (int i = 0; i < kBeams; ++i) {
      const double angle = scan.bearing_rad(static_cast<std::size_t>(i));
      const double wall_m =
          0.5 * kRoom_m / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
      scan.ranges_m.push_back(static_cast<float>(wall_m));
    }
    return scan;
  }

  /// So many messages a second that the receiver's socket holds them.
  void pause() { std::this_thread::sleep_for(std::chrono::microseconds(500)); }

  void publish_node(int id) {
    graph_node_t node{};
    node.utime = utime_ = 1'000'000 + id * 250'000LL;
    node.id = id;
    put(node.T_map_base, on_way(0.3 * id));
    node.sensor = to_message(SensorInfo{}, utime_);
    Scan scan;
    scan.utime = utime_;
    scan.radstep = 0.1;
    scan.ranges_m = {1, 2, 3};
    node.scan = to_message(scan);
    bus_.publish(channel::kNode, node);
    pause();
  }

  void publish_graph() {
    constexpr int kEdgesAChunk = 400;
    std::vector<graph_edge_t> edges;
    const auto add = [&](int from, int to, std::int8_t kind) {
      graph_edge_t edge{};
      edge.id = static_cast<std::int64_t>(edges.size());
      edge.from_node = from;
      edge.to_node = to;
      edge.kind = kind;
      edge.information[0] = edge.information[3] = edge.information[5] = 100;
      edges.push_back(edge);
    };
    for (int id = 1; id < nodes_; ++id) add(id - 1, id, graph_edge_t::SEQUENCE);
    const int row = static_cast<int>(side_ * kRoom_m / 0.3);
    for (int id = 2 * row; id < nodes_; id += 5) add(id - 2 * row, id, graph_edge_t::LOOP);
    const auto chunks = static_cast<int>((edges.size() + kEdgesAChunk - 1) / kEdgesAChunk);
    for (int chunk = 0; chunk < chunks; ++chunk) {
      graph_update_t m = update(true, chunk, chunks);
      const auto begin = edges.begin() + chunk * kEdgesAChunk;
      m.edges.assign(begin, begin + std::min<std::ptrdiff_t>(kEdgesAChunk, edges.end() - begin));
      m.nedges = static_cast<std::int32_t>(m.edges.size());
      bus_.publish(channel::kGraph, m);
      pause();
    }
  }

  graph_update_t update(bool snapshot, int chunk, int chunks) {
    graph_update_t m{};
    m.utime = utime_;
    m.seq = seq_;
    m.epoch = seq_;
    m.snapshot = snapshot;
    m.chunk = chunk;
    m.nchunks = chunks;
    m.nnodes = nodes_;
    return m;
  }

  void move_nodes() {
    ++seq_;
    graph_update_t m = update(false, 0, 1);
    for (int id = std::max(0, nodes_ - 1000); id < nodes_; ++id) {
      node_pose_t pose{};
      pose.id = id;
      Pose2 moved = on_way(0.3 * id);
      moved.y += 0.1 * static_cast<double>(seq_ % 3);
      put(pose.T_map_base, moved);
      m.poses.push_back(pose);
    }
    m.nposes = static_cast<std::int32_t>(m.poses.size());
    bus_.publish(channel::kGraph, m);
  }

  void publish_rooms() {
    constexpr int kAChunk = 100;
    const int chunks = (rooms_ + kAChunk - 1) / kAChunk;
    for (int chunk = 0; chunk < chunks; ++chunk) {
      room_list_t list{};
      list.version = 1;
      list.chunk = chunk;
      list.nchunks = chunks;
      for (int i = chunk * kAChunk; i < std::min(rooms_, (chunk + 1) * kAChunk); ++i) {
        const double x = (i % side_) * kRoom_m, y = (i / side_) * kRoom_m;
        room_t r{};
        r.id = i + 1;
        r.type = room_t::ROOM;
        r.area_m2 = kRoom_m * kRoom_m;
        r.explored = 1;
        r.x = {x + 0.1, x + kRoom_m - 0.1, x + kRoom_m - 0.1, x + 0.1};
        r.y = {y + 0.1, y + 0.1, y + kRoom_m - 0.1, y + kRoom_m - 0.1};
        r.npoints = 4;
        list.rooms.push_back(r);
      }
      list.nrooms = static_cast<std::int32_t>(list.rooms.size());
      bus_.publish(channel::kRooms, list);
      pause();
    }
  }

  void publish_walls() {
    constexpr int kAChunk = 500;
    std::vector<wall_t> walls;
    for (int i = 0; i < rooms_; ++i)
      for (const bool upright : {false, true}) {
        const double x = (i % side_) * kRoom_m, y = (i / side_) * kRoom_m;
        wall_t w{};
        w.id = static_cast<std::int64_t>(walls.size()) + 1;
        w.a[0] = x, w.a[1] = y;
        w.b[0] = upright ? x : x + kRoom_m, w.b[1] = upright ? y + kRoom_m : y;
        w.sigma_m = 0.01;
        w.evidence = 5;
        walls.push_back(w);
      }
    const int chunks = static_cast<int>((walls.size() + kAChunk - 1) / kAChunk);
    for (int chunk = 0; chunk < chunks; ++chunk) {
      wall_list_t list{};
      list.version = 1;
      list.chunk = chunk;
      list.nchunks = chunks;
      const auto begin = walls.begin() + chunk * kAChunk;
      list.walls.assign(begin, begin + std::min<std::ptrdiff_t>(kAChunk, walls.end() - begin));
      list.nwalls = static_cast<std::int32_t>(list.walls.size());
      bus_.publish(channel::kWalls, list);
      pause();
    }
  }

  void publish_tiles() {
    constexpr int kCells = 128;
    constexpr double kResolution_m = 0.05;
    std::vector<std::uint8_t> cells(kCells * kCells, 20);
    for (int i = 0; i < kCells; ++i)
      cells[static_cast<std::size_t>(i)] = cells[static_cast<std::size_t>(i * kCells)] = 250;
    uLongf size = compressBound(cells.size());
    std::vector<std::uint8_t> packed(size);
    compress2(packed.data(), &size, cells.data(), cells.size(), 6);
    packed.resize(size);
    const int tiles = static_cast<int>(side_ * kRoom_m / (kCells * kResolution_m)) + 1;
    for (int x = 0; x < tiles; ++x)
      for (int y = 0; y < tiles; ++y) {
        map_tile_t m{};
        m.version = 1;
        m.tile_x = x;
        m.tile_y = y;
        m.ncells = kCells;
        m.resolution_m = kResolution_m;
        m.encoding = map_tile_t::ZLIB;
        m.data = packed;
        m.nbytes = static_cast<std::int32_t>(packed.size());
        bus_.publish(channel::kMapTile, m);
        pause();
      }
  }

  Transport transport_;
  Bus bus_;
  int nodes_, rooms_, side_;
  std::int64_t utime_ = 1'000'000, steps_ = 0, seq_ = 1;
};

}  // namespace
}  // namespace modslam

int main(int argc, char** argv) {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  int nodes = 10'000, rooms = 1'000;
  CLI::App app("Plays a big made-up building to the viewer.");
  app.add_option("--url", url, "LCM url")->capture_default_str();
  app.add_option("--nodes", nodes, "of the graph")
      ->capture_default_str()
      ->check(CLI::Range(10, 100'000));
  app.add_option("--rooms", rooms, "of the building")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000));
  CLI11_PARSE(app, argc, argv);

  modslam::BigBuilding building(url, nodes, rooms);
  building.say_all();
  std::cout << "ready" << std::endl;
  for (auto next = modslam::Clock::now();;
       next += std::chrono::microseconds(1'000'000 / modslam::kScans_hz)) {
    std::this_thread::sleep_until(next);
    building.step();
  }
}
