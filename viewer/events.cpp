// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/events.hpp"

#include <cstdio>

#include "viewer/verdict.hpp"

namespace modslam {
namespace {

constexpr std::size_t kMaxProcesses = 1000;

std::string text(const char* format, double value) {
  char words[64];
  std::snprintf(words, sizeof words, format, value);
  return words;
}

}  // namespace

void Events::say(std::int64_t utime, const std::string& kind, const std::string& words) {
  events_.push_back({utime, kind, words});
  if (events_.size() > kKept) events_.pop_front();
  changed_ = true;
}

void Events::see_pose(const pose_estimate_t& message) {
  const bool bad = !is_good(message.verdict) && message.verdict != scan_match_t::DEGENERATE;
  if (bad && !was_bad_)
    say(message.utime, "match", std::string("match failed: ") + verdict_word(message.verdict));
  if (!bad && was_bad_) say(message.utime, "match", "matches again");
  was_bad_ = bad;
}

void Events::see_status(std::int64_t utime, const process_status_t& message) {
  const auto known = processes_.find(message.name);
  if (known == processes_.end() && processes_.size() >= kMaxProcesses) return;
  Process& process = processes_[message.name];
  if (process.pid != 0 && process.pid != message.pid && message.pid != 0)
    say(utime, "process", message.name + " was started again");
  const bool troubled = message.state == process_status_t::TROUBLED;
  if (troubled && process.state != process_status_t::TROUBLED)
    say(utime, "process", message.name + " is in trouble: " + message.words);
  if (message.state == process_status_t::STOPPED && process.state != process_status_t::STOPPED)
    say(utime, "process", message.name + " has stopped");
  process = {message.pid, message.state};
}

void Events::see_list(std::int64_t utime, const std::string& stream, const nlohmann::json& items) {
  constexpr std::size_t kMaxKnown = 100'000;
  for (const nlohmann::json& item : items) {
    const std::int64_t id = item.at("id");
    if (known_.size() >= kMaxKnown || !known_.insert({stream, id}).second) continue;
    if (stream == "rooms") {
      const std::string name = item.at("name"), type = item.at("type");
      say(utime, "room",
          (name.empty() ? type + " " + std::to_string(id) : name) + " found, " +
              text("%.1f m²", item.at("area_m2")));
    } else {
      say(utime, "door",
          "door " + std::to_string(id) + " found, " + text("%.2f m wide", item.at("width_m")));
    }
  }
}

void Events::forget_map() {
  events_.clear();
  known_.clear();
  was_bad_ = false;
  changed_ = true;
}

nlohmann::json Events::to_json() const {
  nlohmann::json items = nlohmann::json::array();
  for (const Event& event : events_) items.push_back({event.utime, event.kind, event.words});
  return {{"stream", "events"}, {"items", std::move(items)}};
}

}  // namespace modslam
