// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/run_record.hpp"

#include <functional>
#include <modslam/loop_closure_t.hpp>
#include <modslam/map_tile_t.hpp>
#include <modslam/parameters_t.hpp>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <new>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"

namespace modslam::report {
namespace {

MapTile to_tile(const map_tile_t& message) {
  if (message.encoding != map_tile_t::ZLIB) throw BadMessage("a tile of unknown encoding");
  if (!(message.resolution_m > 1e-4 && message.resolution_m < 100))
    throw BadMessage("a tile of no resolution");
  if (std::abs(static_cast<double>(message.tile_x)) > 1e6 ||
      std::abs(static_cast<double>(message.tile_y)) > 1e6)
    throw BadMessage("a tile out of this world");
  try {
    return {message.tile_x, message.tile_y, message.ncells, message.resolution_m,
            unpack_cells(message.data.data(), message.data.size(), message.ncells)};
  } catch (const std::runtime_error& error) {
    throw BadMessage(error.what());
  }
}

TrackedPose to_tracked(const pose_estimate_t& message) {
  return {message.utime, message.node_id, to_pose(message.T_node_base),
          to_pose(message.T_map_base), message.node_before, to_pose(message.T_before_base)};
}

PathPose to_stamped(const bot_core::pose_t& message) {
  const TimedPose pose = to_timed_pose(message);
  return {pose.utime, pose.pose};
}

void put_tile(RunRecord& run, const map_tile_t& message) {
  const MapTile tile = to_tile(message);
  // A map of another kind was begun: the old tiles are no part of it.
  if (!run.tiles.empty()) {
    const MapTile& old = run.tiles.begin()->second;
    if (old.ncells != tile.ncells || old.resolution_m != tile.resolution_m) run.tiles.clear();
  }
  run.tiles[{tile.x, tile.y}] = tile;
}

/// One reader a channel.
class Readers {
 public:
  explicit Readers(RunRecord& run) {
    on<bot_core::planar_lidar_t>(channel::kLaser,
                                 [&](const auto& m) { run.laser_utimes.push_back(m.utime); });
    on<sensor_info_t>(channel::kSensorInfo, [&](const auto& m) { run.sensor = to_sensor_info(m); });
    on<bot_core::pose_t>(channel::kOdometry,
                         [&](const auto& m) { run.odometry.push_back(to_stamped(m)); });
    on<bot_core::pose_t>(channel::kGroundTruth,
                         [&](const auto& m) { run.truth.push_back(to_stamped(m)); });
    on<scan_match_t>(channel::kScanMatch, [&](const auto& m) {
      run.match_verdicts.push_back({m.utime, m.verdict});
    });
    on<pose_estimate_t>(channel::kPose, [&](const auto& m) {
      run.poses.push_back(to_tracked(m));
      run.pose_verdicts.push_back({m.utime, m.verdict});
    });
    on<graph_node_t>(channel::kNode, [&](const auto& m) {
      if (!run.graph.take(m)) return;
      // The nodes that the poses so far hang on are gone: they stay where they were.
      for (TrackedPose& pose : run.poses) pose.node = pose.node_before = -1;
    });
    on<graph_update_t>(channel::kGraph, [&](const auto& m) { run.graph.take(m); });
    on<loop_closure_t>(channel::kLoop, [&](const auto& m) {
      run.proposals.push_back({m.utime, m.from_node, m.to_node, m.verdict});
    });
    on<map_tile_t>(channel::kMapTile, [&](const auto& m) { put_tile(run, m); });
    on<wall_list_t>(channel::kWalls, [&](const auto& m) { run.semantics.walls.take(m); });
    on<room_list_t>(channel::kRooms, [&](const auto& m) { run.semantics.rooms.take(m); });
    on<door_list_t>(channel::kDoors, [&](const auto& m) { run.semantics.doors.take(m); });
    on<object_list_t>(channel::kObjects, [&](const auto& m) { run.semantics.objects.take(m); });
    on<place_list_t>(channel::kPlaces, [&](const auto& m) { run.semantics.places.take(m); });
    on<process_status_t>(channel::kStatus, [&](const auto& m) { run.last_status[m.name] = m; });
    on<parameters_t>(channel::kParameters, [&](const auto& m) { run.parameters[m.name] = m.toml; });
    on<sim_info_t>(channel::kSimInfo, [&](const auto& m) { run.sim = m; });
  }

  void read(const LogEvent& event, ChannelTally& tally) {
    ++tally.messages;
    const auto reader = readers_.find(event.channel);
    if (reader == readers_.end()) return;
    try {
      reader->second(event.bytes);
    } catch (const BadMessage&) {
      ++tally.undecodable;
    } catch (const std::length_error&) {  // a wild array length
      ++tally.undecodable;
    } catch (const std::bad_alloc&) {
      ++tally.undecodable;
    }
  }

 private:
  template <class Message, class Take>
  void on(const char* channel, Take take) {
    readers_[channel] = [take](const std::vector<char>& bytes) {
      Message message{};
      const int size = static_cast<int>(bytes.size());
      if (message.decode(bytes.data(), 0, size) != size) throw BadMessage("cannot be decoded");
      take(message);
    };
  }
  std::map<std::string, std::function<void(const std::vector<char>&)>> readers_;
};

}  // namespace

RunRecord read_run(const std::string& log_path) {
  RunRecord run;
  LogReader log(log_path);
  Readers readers(run);
  for (LogEvent event; log.next(event);) readers.read(event, run.channels[event.channel]);
  add_lost_nodes(run.poses, run.graph.node_utimes(), run.graph.edges());
  run.damage = log.damage();
  return run;
}

const char* verdict_name(int verdict) {
  static const char* const names[kVerdicts] = {
      "invalid", "ok", "degenerate", "ambiguous", "low overlap", "inconsistent", "failed", "first"};
  return names[verdict >= 0 && verdict < kVerdicts ? verdict : 0];
}

}  // namespace modslam::report
