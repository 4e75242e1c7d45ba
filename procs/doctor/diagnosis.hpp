// SPDX-License-Identifier: BSD-3-Clause
/// @file What is wrong with a machine or a run, in plain words, from what was seen of them.
#pragma once
#include <cstdint>
#include <map>
#include <modslam/process_status_t.hpp>
#include <set>
#include <string>
#include <vector>

namespace modslam::doctor {

/// What the machine offers.
struct Machine {
  std::string multicast;             ///< preflight(): "" or what is wrong
  std::int64_t receive_buffer = 0;   ///< [bytes] largest that a socket gets
  double disk_free = 1e12;           ///< [bytes] where runs are written
  bool folder_writable = true;
  std::string folder;
  bool java = true;
};

/// One sensor's channel over the time that was listened.
struct Stream {
  std::int64_t messages = 0, backward_steps = 0, repeated = 0;
  std::int64_t first_utime = 0, last_utime = 0;
  double last_heard_s = 0;  ///< since the beginning of listening
  void take(std::int64_t utime, double now_s);
  double rate_hz() const;   ///< in message time
};

/// What was heard of a run.
struct Run {
  double listened_s = 0;
  Stream laser, odometry, ins, pose;
  std::vector<double> odometry_behind_s;  ///< at each laser message: its time minus that of the newest odometry
  std::int64_t beams = 0, beams_without_return = 0;
  std::map<std::string, process_status_t> status;     ///< newest of each process
  std::map<std::string, std::set<std::int32_t>> pids;  ///< that spoke for each process
  std::vector<std::string> expected;                   ///< processes that should speak
};

struct Finding {
  bool serious;  ///< the run suffers; else it is worth knowing
  std::string words;
};

std::vector<Finding> diagnose(const Machine& machine);
std::vector<Finding> diagnose(const Run& run);

}  // namespace modslam::doctor
