// SPDX-License-Identifier: BSD-3-Clause
/// @file What happened during the run, in words, newest last.
#pragma once
#include <deque>
#include <map>
#include <modslam/pose_estimate_t.hpp>
#include <modslam/process_status_t.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>

namespace modslam {

/// Turns what the viewer sees into a list of events that is never longer than kKept.
class Events {
 public:
  static constexpr std::size_t kKept = 200;

  void say(std::int64_t utime, const std::string& kind, const std::string& words);
  /// A pose whose verdict is worse or better than the one before.
  void see_pose(const pose_estimate_t& message);
  /// A process that began, began anew, or says that it is in trouble.
  void see_status(std::int64_t utime, const process_status_t& message);
  /// Things with an id that was not there before. `stream` is rooms or doors, `items` its content.
  void see_list(std::int64_t utime, const std::string& stream, const nlohmann::json& items);
  /// Another session's graph has begun; processes are the same.
  void forget_map();

  /// True once after something was added.
  bool take_changed() { return std::exchange(changed_, false); }
  nlohmann::json to_json() const;

 private:
  struct Event {
    std::int64_t utime;
    std::string kind, words;
  };
  struct Process {
    int pid = 0, state = 0;
  };
  std::deque<Event> events_;
  std::map<std::string, Process> processes_;
  std::set<std::pair<std::string, std::int64_t>> known_;
  bool was_bad_ = false, changed_ = true;
};

}  // namespace modslam
