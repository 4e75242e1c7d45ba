// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/catch_up.hpp"

#include <algorithm>
#include <chrono>
#include <modslam/process_status_t.hpp>
#include <thread>

#include "common/bus/channels.hpp"
#include "common/bus/journal.hpp"

namespace modslam {
namespace {

constexpr std::int64_t kBefore_us = 5'000'000;  // sources are needed from somewhat earlier than the last message that was handled
constexpr int kSpeakEvery_ms = 200;
constexpr std::size_t kTail = std::size_t{8} << 20;

std::int64_t wall_clock_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Every message begins with its type's fingerprint and its time.
std::int64_t utime_of(const LogEvent& event) {
  std::uint64_t value = 0;
  if (event.bytes.size() < 16) return 0;
  for (int k = 8; k < 16; ++k) value = value << 8 | static_cast<unsigned char>(event.bytes[static_cast<std::size_t>(k)]);
  return static_cast<std::int64_t>(value);
}

/// Events since `since_us` of wall time. @return an empty list when there is no log.
std::vector<LogEvent> events_since(const std::string& path, std::int64_t since_us) {
  for (std::size_t tail = kTail;; tail *= 8) {
    std::vector<LogEvent> events;
    std::int64_t first_us = 0;
    try {
      LogReader reader(path, tail);
      for (LogEvent event; reader.next(event);) {
        if (first_us == 0) first_us = event.utime;
        if (event.utime >= since_us) events.push_back(std::move(event));
      }
      if (first_us < since_us || !reader.is_tail()) return events;
    } catch (const std::runtime_error&) {
      return {};
    }
  }
}

bool is_word_of(const LogEvent& event, const std::string& name, int pid) {
  process_status_t status{};
  return event.channel == channel::kStatus && read_record(event, status) && status.name == name && status.pid == pid;
}

/// Leaves out what is on other channels, and what was handled.
std::vector<LogEvent> only_missed(std::vector<LogEvent> events, const Resumption& resumption) {
  const auto drives = [&](const LogEvent& event) { return event.channel == resumption.last_channel; };
  const auto last = std::find_if(events.rbegin(), events.rend(), [&](const LogEvent& event) {
    return drives(event) && utime_of(event) == resumption.last_utime;
  });
  const auto handled_before = events.rend() - last;  // as an index
  std::vector<LogEvent> missed;
  for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(events.size()); ++k) {
    LogEvent& event = events[static_cast<std::size_t>(k)];
    if (std::find(resumption.channels.begin(), resumption.channels.end(), event.channel) == resumption.channels.end()) continue;
    if (drives(event) && (k < handled_before || (last == events.rend() && utime_of(event) <= resumption.last_utime))) continue;
    missed.push_back(std::move(event));
  }
  return missed;
}

}  // namespace

Missed read_missed(const std::string& run_log, const Resumption& resumption, const std::string& name, int pid, int patience_ms,
                   const std::function<void()>& speak) {
  const auto start = std::chrono::steady_clock::now();
  const std::int64_t start_us = wall_clock_us();
  const auto waited_ms = [&] {
    return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - start).count();
  };
  for (std::int64_t words = 0;;) {
    if (words * kSpeakEvery_ms <= waited_ms()) {
      speak();
      ++words;
    }
    std::vector<LogEvent> events = events_since(run_log, resumption.last_wall_us - kBefore_us);
    auto cut = std::find_if(events.begin(), events.end(), [&](const LogEvent& event) { return is_word_of(event, name, pid); });
    const bool found = cut != events.end();
    if (found || waited_ms() > patience_ms) {
      if (!found || cut->utime > start_us + 1000 * kSpeakEvery_ms)  // the first word was not recorded
        cut = std::find_if(events.begin(), events.end(), [&](const LogEvent& event) { return event.utime > start_us; });
      events.erase(cut, events.end());
      return {only_missed(std::move(events), resumption), found};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace modslam
