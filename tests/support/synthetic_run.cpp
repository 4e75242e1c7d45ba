// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/synthetic_run.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <modslam/door_list_t.hpp>
#include <modslam/graph_node_t.hpp>
#include <modslam/graph_update_t.hpp>
#include <modslam/loop_closure_t.hpp>
#include <modslam/map_tile_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/parameters_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/process_status_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/sim_info_t.hpp>
#include <modslam/wall_list_t.hpp>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "common/maps/mosaic.hpp"

namespace modslam::test {
namespace {

using Segment = std::array<double, 4>;
constexpr double kResolution_m = 0.05;
constexpr int kTile_cells = 128;

// Two rooms of 8 x 8 m, one door between them, a corridor below with a door to each, a pillar in
// each room.
const std::vector<Segment> kWalls = {{0, 0, 3.5, 0},  {4.5, 0, 11.5, 0}, {12.5, 0, 16, 0},
                                     {16, -2, 16, 8}, {16, 8, 0, 8},     {0, 8, 0, -2},
                                     {0, -2, 16, -2}, {8, 0, 8, 3},      {8, 5, 8, 8}};
const std::vector<Segment> kDoors = {{8, 3, 8, 5}, {3.5, 0, 4.5, 0}, {11.5, 0, 12.5, 0}};
const std::vector<Segment> kPillars = {{2.6, 3.7, 3.2, 4.3},
                                       {12.8, 3.7, 13.4, 4.3}};  // x0 y0 x1 y1

/// Figure-eight through (8, 4); one lap is a turn of `phase`.
Pose2 route(double phase) {
  const double x = 8 + 5.5 * std::sin(phase), y = 4 + 2.4 * std::sin(2 * phase);
  return {x, y, std::atan2(4.8 * std::cos(2 * phase), 5.5 * std::cos(phase))};
}

double ray(const Pose2& T_world_laser, double bearing_rad) {
  static const std::vector<Segment> solid = [] {
    std::vector<Segment> all = kWalls;
    for (const auto& [x0, y0, x1, y1] : kPillars)
      for (const Segment& s :
           {Segment{x0, y0, x1, y0}, {x1, y0, x1, y1}, {x1, y1, x0, y1}, {x0, y1, x0, y0}})
        all.push_back(s);
    return all;
  }();
  const double angle = T_world_laser.heading + bearing_rad, cx = std::cos(angle),
               cy = std::sin(angle);
  double nearest = 30;
  for (const auto& [ax, ay, bx, by] : solid) {
    const double ex = bx - ax, ey = by - ay, det = cx * ey - cy * ex;
    if (std::abs(det) < 1e-12) continue;
    const double dx = ax - T_world_laser.x, dy = ay - T_world_laser.y;
    const double along = (dx * ey - dy * ex) / det, share = (dx * cy - dy * cx) / det;
    if (along > 0 && share >= 0 && share <= 1) nearest = std::min(nearest, along);
  }
  return nearest;
}

Scan scan_at(const Pose2& T_world_laser, std::int64_t utime) {
  Scan scan{utime, {}, -kPi / 2, kPi / 180};
  for (int i = 0; i <= 180; ++i)
    scan.ranges_m.push_back(static_cast<float>(ray(T_world_laser, scan.bearing_rad(i))));
  return scan;
}

/// Counts of hits and passes on a lattice of the map frame.
class Canvas {
 public:
  void add(const Pose2& T_map_laser, const Scan& scan) {
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i)
      for (double r = 0; r <= scan.ranges_m[i] + 1e-6; r += kResolution_m / 2) {
        const double angle = T_map_laser.heading + scan.bearing_rad(i);
        touch(T_map_laser.x + r * std::cos(angle), T_map_laser.y + r * std::sin(angle),
              r > scan.ranges_m[i] - kResolution_m / 2);
      }
  }
  std::vector<map_tile_t> tiles(std::int64_t utime) const {
    std::vector<map_tile_t> out;
    for (const auto& [place, odds] : odds_) {
      std::vector<std::uint8_t> cells;
      for (const double o : odds)
        cells.push_back(
            o == 0 ? 0 : static_cast<std::uint8_t>(1 + std::lround(254 / (1 + std::exp(-o)))));
      map_tile_t tile{};
      tile.utime = utime;
      tile.version = 1;
      tile.tile_x = place.first;
      tile.tile_y = place.second;
      tile.ncells = kTile_cells;
      tile.resolution_m = kResolution_m;
      tile.encoding = map_tile_t::ZLIB;
      tile.data = pack_cells(cells);
      tile.nbytes = static_cast<int>(tile.data.size());
      out.push_back(tile);
    }
    return out;
  }

 private:
  void touch(double x, double y, bool hit) {
    const int column = static_cast<int>(std::floor(x / kResolution_m)),
              row = static_cast<int>(std::floor(y / kResolution_m));
    const auto tile_of = [](int c) { return (c >= 0 ? c : c - kTile_cells + 1) / kTile_cells; };
    auto& odds = odds_[{tile_of(column), tile_of(row)}];
    odds.resize(kTile_cells * kTile_cells);
    double& o = odds[static_cast<std::size_t>((row - tile_of(row) * kTile_cells) * kTile_cells +
                                              column - tile_of(column) * kTile_cells)];
    o = std::clamp(o + (hit ? 1.2 : -0.15), -4.0, 4.0);
  }
  std::map<std::pair<int, int>, std::vector<double>> odds_;
};

template <class List, class Item>
List whole_list(std::int64_t utime, std::vector<Item> List::*items, std::int32_t List::*count,
                std::vector<Item> values) {
  List list{};
  list.utime = utime;
  list.version = 3;
  list.nchunks = 1;
  list.*count = static_cast<int>(values.size());
  list.*items = std::move(values);
  return list;
}

room_t make_room(std::int64_t id, const char* name, int type, const Pose2& T_map_world, double x0,
                 double y0, double x1, double y1) {
  room_t room{};
  room.id = id;
  room.name = name;
  room.type = static_cast<std::int8_t>(type);
  room.area_m2 = (x1 - x0) * (y1 - y0);
  room.explored = 0.97;
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}}) {
    room.x.push_back((T_map_world * p).x());
    room.y.push_back((T_map_world * p).y());
  }
  room.npoints = 4;
  return room;
}

template <class Item>
void put_line(Item& item, const Pose2& T_map_world, const Segment& s) {
  const Eigen::Vector2d a = T_map_world * Eigen::Vector2d(s[0], s[1]),
                        b = T_map_world * Eigen::Vector2d(s[2], s[3]);
  item.a[0] = a.x(), item.a[1] = a.y(), item.b[0] = b.x(), item.b[1] = b.y();
}

void write_semantics(LogWriter& log, std::int64_t utime, const Pose2& T_map_world) {
  std::vector<wall_t> walls;
  for (const Segment& s : kWalls) {
    wall_t wall{};
    wall.id = static_cast<std::int64_t>(walls.size()) + 1;
    put_line(wall, T_map_world, s);
    wall.evidence = 3.2;
    wall.sigma_m = 0.011;
    walls.push_back(wall);
  }
  std::vector<door_t> doors;
  const std::int64_t rooms_of[3][2] = {{1, 2}, {1, 3}, {2, 3}};
  for (const Segment& s : kDoors) {
    door_t door{};
    door.room_a = rooms_of[doors.size()][0];
    door.room_b = rooms_of[doors.size()][1];
    door.id = static_cast<std::int64_t>(doors.size()) + 1;
    put_line(door, T_map_world, s);
    door.width_m = std::hypot(s[2] - s[0], s[3] - s[1]);
    door.evidence = 2.5;
    door.state = door_t::OPEN;
    doors.push_back(door);
  }
  std::vector<object_t> objects;
  for (const auto& [x0, y0, x1, y1] : kPillars) {
    const room_t shape = make_room(0, "", 0, T_map_world, x0, y0, x1, y1);
    object_t object{};
    object.id = static_cast<std::int64_t>(objects.size()) + 1;
    object.class_name = "pillar";
    object.area_m2 = shape.area_m2;
    object.x = shape.x, object.y = shape.y, object.npoints = shape.npoints;
    objects.push_back(object);
  }
  // Walls come in two chunks, the later one first: order must not matter.
  wall_list_t first = whole_list(utime, &wall_list_t::walls, &wall_list_t::nwalls, walls),
              second = first;
  first.nchunks = second.nchunks = 2;
  first.walls.resize(5), first.nwalls = 5;
  second.walls.erase(second.walls.begin(), second.walls.begin() + 5),
      second.nwalls = static_cast<int>(second.walls.size());
  second.chunk = 1;
  log.write(utime, channel::kWalls, second);
  log.write(utime, channel::kWalls, first);
  log.write(utime, channel::kRooms,
            whole_list(utime, &room_list_t::rooms, &room_list_t::nrooms,
                       {make_room(1, "Workshop <A> & co", room_t::ROOM, T_map_world, 0, 0, 8, 8),
                        make_room(2, "", room_t::ROOM, T_map_world, 8, 0, 16, 8),
                        make_room(3, "", room_t::CORRIDOR, T_map_world, 0, -2, 16, 0)}));
  log.write(utime, channel::kDoors,
            whole_list(utime, &door_list_t::doors, &door_list_t::ndoors, doors));
  log.write(utime, channel::kObjects,
            whole_list(utime, &object_list_t::objects, &object_list_t::nobjects, objects));
}

graph_edge_t make_edge(std::int64_t id, std::int64_t from, std::int64_t to, int kind,
                       const Pose2& T_from_to) {
  graph_edge_t edge{};
  edge.id = id;
  edge.from_node = from;
  edge.to_node = to;
  edge.kind = static_cast<std::int8_t>(kind);
  put(edge.T_from_to, T_from_to);
  put(edge.information, Eigen::Vector3d(2500, 2500, 10000).asDiagonal());
  return edge;
}

/// The estimator that drifts on the first lap, in the order its messages come.
class Estimator {
 public:
  Estimator(LogWriter& log, const SensorInfo& sensor) : log_(log), sensor_(sensor) {}

  /// @param T_map_true  where the robot is, for the optimiser that knows it.
  void step(const Scan& scan, const Pose2& T_map_true, bool publish_pose) {
    if (seq_ == 0) T_map_base_ = T_map_true;
    if (seq_ > 0) {
      Pose2 motion = between(T_map_true_, T_map_true);
      motion.x *= 1.01;  // what dead reckoning gets wrong
      motion.heading += 0.00012;
      T_map_base_ = T_map_base_ * motion;
    }
    T_map_true_ = T_map_true;
    if (nodes.empty() || distance(nodes.back(), T_map_base_) > 0.5) add_node(scan);
    if (publish_pose) publish(scan.utime);
    ++seq_;
  }

  /// What the optimiser says in the end.
  void settle(std::int64_t utime) {
    nodes = true_nodes;
    update(utime, {}, true);
  }

  std::vector<Pose2> nodes, true_nodes;
  int loop_edges = 0;

 private:
  void add_node(const Scan& scan) {
    graph_node_t node{};
    node.utime = scan.utime;
    node.id = static_cast<std::int64_t>(nodes.size());
    put(node.T_map_base, T_map_base_);
    node.sensor = to_message(sensor_, scan.utime);
    node.scan = to_message(scan);
    log_.write(scan.utime, channel::kNode, node);
    std::vector<graph_edge_t> edges;
    if (!nodes.empty()) {
      node_before_ = node.id - 1;
      T_before_base_ = between(nodes.back(), T_map_base_);
      edges.push_back(make_edge(edges_++, node.id - 1, node.id, graph_edge_t::SEQUENCE, T_before_base_));
    }
    nodes.push_back(T_map_base_);
    true_nodes.push_back(T_map_true_);
    update(scan.utime, edges, false);
    close_loop(scan.utime);
  }

  /// Proposes the nearest old node; then the graph is put where it belongs.
  void close_loop(std::int64_t utime) {
    const int to = static_cast<int>(nodes.size()) - 1;
    for (int from = 0; from < to - 30; ++from) {
      if (distance(true_nodes[from], true_nodes[to]) > 0.3 || to % 4 != 0) continue;
      loop_closure_t loop{};
      loop.utime = utime;
      loop.seq = ++proposals_;
      loop.from_node = from;
      loop.to_node = to;
      const bool good = proposals_ % 3 != 2;
      loop.verdict = good ? scan_match_t::OK : scan_match_t::AMBIGUOUS;
      log_.write(utime, channel::kLoop, loop);
      if (!good) return;
      nodes = true_nodes;
      T_map_base_ = T_map_true_;
      ++loop_edges;
      update(utime,
             {make_edge(edges_++, from, to, graph_edge_t::LOOP,
                        between(true_nodes[from], true_nodes[to]))},
             true);
      return;
    }
  }

  void update(std::int64_t utime, const std::vector<graph_edge_t>& edges, bool moved) {
    graph_update_t update{};
    update.utime = utime;
    update.seq = ++updates_;
    update.epoch = loop_edges;
    update.nchunks = 1;
    update.nnodes = static_cast<std::int64_t>(nodes.size());
    update.edges = edges;
    update.nedges = static_cast<int>(edges.size());
    for (std::size_t i = 0; moved && i < nodes.size(); ++i) {
      node_pose_t pose{};
      pose.id = static_cast<std::int64_t>(i);
      put(pose.T_map_base, nodes[i]);
      update.poses.push_back(pose);
    }
    update.nposes = static_cast<int>(update.poses.size());
    log_.write(utime, channel::kGraph, update);
  }

  void publish(std::int64_t utime) {
    pose_estimate_t pose{};
    pose.utime = utime;
    pose.seq = seq_;
    put(pose.T_map_base, T_map_base_);
    pose.verdict = seq_ == 0 ? scan_match_t::FIRST : scan_match_t::OK;
    pose.node_id = static_cast<std::int64_t>(nodes.size()) - 1;
    put(pose.T_node_base, between(nodes.back(), T_map_base_));
    pose.node_before = std::exchange(node_before_, -1);
    put(pose.T_before_base, T_before_base_ * between(nodes.back(), T_map_base_));
    log_.write(utime, channel::kPose, pose);
  }

  LogWriter& log_;
  SensorInfo sensor_;
  Pose2 T_map_base_, T_map_true_, T_before_base_;
  std::int64_t node_before_ = -1;  ///< of a scan that has just become a node
  std::int64_t seq_ = 0, edges_ = 0, updates_ = 0, proposals_ = 0;
};

void write_head(LogWriter& log, const SensorInfo& sensor, std::int64_t utime) {
  log.write(utime, channel::kSensorInfo, to_message(sensor, utime));
  sim_info_t sim{};
  sim.utime = utime;
  sim.world = "two_rooms.geojson";
  sim.route = "figure_eight";
  sim.noise = "none";
  sim.seed = 7;
  log.write(utime, channel::kSimInfo, sim);
  for (const char* name : {"scan_matcher", "graph_optimizer"}) {
    parameters_t parameters{};
    parameters.name = name;
    parameters.toml = "[launch]\nestimator = \"graph_optimizer\"\nsemantics = true\n";
    log.write(utime, channel::kParameters, parameters);
  }
}

void write_status(LogWriter& log, std::int64_t utime) {
  for (const char* name : {"scan_matcher", "graph_optimizer"}) {
    process_status_t status{};
    status.utime = utime;
    status.name = name;
    status.state = process_status_t::FINISHED;
    channel_count_t count{};
    count.channel = channel::kLaser;
    count.received = 1200;
    count.bad = 2;
    status.inputs = {count};
    status.ninputs = 1;
    status.latency_p50_us =
        utime % 977;  // differs between machines, must not be seen in the results
    log.write(utime, channel::kStatus, status);
  }
}

int match_verdict(int scan) {
  if (scan == 0) return scan_match_t::FIRST;
  if (scan % 300 > 270) return scan_match_t::DEGENERATE;
  return scan % 211 == 0 ? scan_match_t::LOW_OVERLAP : scan_match_t::OK;
}

}  // namespace

SyntheticRun write_synthetic_run(const std::string& log_path, int scans, int drop_pose_every,
                                 std::int64_t start_utime) {
  SyntheticRun run;
  run.T_base_laser = {0.2, 0, 0};
  run.T_world_map = route(0);
  const SensorInfo sensor{run.T_base_laser, 0.05, 20, false, 0};
  LogWriter log(log_path);
  write_head(log, sensor, start_utime);
  Estimator estimator(log, sensor);
  Canvas canvas;
  Pose2 T_odom_base;
  std::int64_t utime = start_utime;
  for (int i = 0; i < scans; ++i, utime += 100'000) {
    const Pose2 T_world_base = route(2 * kPi * i / 600);
    if (i > 0) {
      Pose2 motion = between(run.truth.back().pose, T_world_base);
      motion.heading += 0.0007;
      T_odom_base = T_odom_base * motion;
      if (i < 600) run.lap_m += distance(run.truth.back().pose, T_world_base);
    }
    run.truth.push_back({utime, T_world_base});
    const Scan scan = scan_at(T_world_base * run.T_base_laser, utime);
    const Pose2 T_map_true = between(run.T_world_map, T_world_base);
    log.write(utime, channel::kGroundTruth, to_message(TimedPose{utime, T_world_base}));
    log.write(utime, channel::kOdometry, to_message(TimedPose{utime, T_odom_base}));
    log.write(utime, channel::kLaser, to_message(scan));
    scan_match_t match{};
    match.utime = utime;
    match.verdict = static_cast<std::int8_t>(match_verdict(i));
    log.write(utime, channel::kScanMatch, match);
    estimator.step(scan, T_map_true,
                   !drop_pose_every || i % drop_pose_every != drop_pose_every - 1);
    if (i % 5 == 0) canvas.add(T_map_true * run.T_base_laser, scan);
  }
  estimator.settle(utime);
  for (const map_tile_t& tile : canvas.tiles(utime)) log.write(utime, channel::kMapTile, tile);
  write_semantics(log, utime, run.T_world_map.inverse());
  write_status(log, utime);
  log.close();
  run.nodes = static_cast<int>(estimator.nodes.size());
  run.loop_edges = estimator.loop_edges;
  return run;
}

std::string synthetic_world_geojson() {
  std::string features;
  const auto add = [&](const char* kind, const Segment& s) {
    features += std::string(features.empty() ? "" : ",") +
                "{\"type\":\"Feature\",\"properties\":{\"kind\":\"" + kind +
                "\"},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[" +
                std::to_string(s[0]) + "," + std::to_string(s[1]) + "],[" + std::to_string(s[2]) +
                "," + std::to_string(s[3]) + "]]}}\n";
  };
  for (const Segment& s : kWalls) add("wall", s);
  for (const Segment& s : kDoors) add("door", s);
  const Segment rooms[] = {{0, 0, 8, 8}, {8, 0, 16, 8}, {0, -2, 16, 0}};  // x0 y0 x1 y1
  int id = 0;
  for (const auto& [x0, y0, x1, y1] : rooms) {
    char room[400];
    std::snprintf(room, sizeof room,
                  ",{\"type\":\"Feature\",\"properties\":{\"kind\":\"room\",\"id\":%d},"
                  "\"geometry\":{\"type\":"
                  "\"Polygon\",\"coordinates\":[[[%g,%g],[%g,%g],[%g,%g],[%g,%g],[%g,%g]]]}}\n",
                  ++id, x0, y0, x1, y0, x1, y1, x0, y1, x0, y0);
    features += room;
  }
  return "{\"type\":\"FeatureCollection\",\"features\":[" + features + "]}\n";
}

}  // namespace modslam::test
