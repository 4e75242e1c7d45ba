// SPDX-License-Identifier: BSD-3-Clause
/// @file What a run's LCM log says, read once from front to back.
#pragma once
#include <cstdint>
#include <map>
#include <modslam/process_status_t.hpp>
#include <modslam/sim_info_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/path_pose.hpp"
#include "common/graph/trajectory.hpp"
#include "common/maps/mosaic.hpp"
#include "procs/report/graph_record.hpp"
#include "procs/report/semantic_record.hpp"

namespace modslam::report {

/// [s] Stamps of a broken log may lie farther apart than their type can count.
inline double seconds_between(std::int64_t from_utime, std::int64_t to_utime) {
  return 1e-6 * (static_cast<double>(to_utime) - static_cast<double>(from_utime));
}

struct ChannelTally {
  std::int64_t messages = 0, undecodable = 0;
};

struct Judged {  ///< a moment and the verdict on it (values of scan_match_t)
  std::int64_t utime = 0;
  int verdict = 0;
};

struct LoopProposal {
  std::int64_t utime = 0;
  NodeId from = 0, to = 0;
  int verdict = 0;
};

struct RunRecord {
  std::string damage;  ///< of the file, in words; "" = none
  std::map<std::string, ChannelTally> channels;
  std::vector<std::int64_t> laser_utimes;  ///< in file order
  std::vector<PathPose> odometry, truth;
  std::map<std::string, std::vector<PathPose>> peers;  ///< paths of other systems on the same log, by name
  std::vector<TrackedPose> poses;
  std::vector<Judged> pose_verdicts, match_verdicts;
  std::vector<LoopProposal> proposals;
  std::optional<SensorInfo> sensor;  ///< as SENSOR_INFO says; the nodes carry what was in force
  std::optional<sim_info_t> sim;
  GraphRecord graph;
  SemanticRecord semantics;
  std::map<std::pair<int, int>, MapTile> tiles;
  std::map<std::string, process_status_t> last_status;  ///< by process
  std::map<std::string, std::string> parameters;        ///< by process: TOML
};

/// @throws std::runtime_error when the log is missing or no LCM log. Damage inside it does not
/// throw.
RunRecord read_run(const std::string& log_path);

/// "ok", "degenerate", …
const char* verdict_name(int verdict);
constexpr int kVerdicts = 8;  ///< 0 (invalid) .. 7

}  // namespace modslam::report
