// SPDX-License-Identifier: BSD-3-Clause
/// modslam-check-log: says what an LCM log holds and where it is damaged, and copies what can be read.
/// Exit code 0: whole; 1: no log, or without a channel that is needed; 2: damaged.
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>

#include "common/bus/log.hpp"

namespace {

struct Options {
  std::string log, mended;
  std::vector<std::string> needs;
};

constexpr std::int64_t kJump_us = 10'000'000;

/// Hands on every readable event. A stamp that is far from the events before and after it is a flipped bit, and the stock player would wait
/// for it: it gets the stamp of the event before. @return how many there were.
int for_readable(const std::string& path, const std::function<void(const modslam::LogEvent&)>& take) {
  modslam::LogReader reader(path);
  modslam::LogEvent event, next;
  if (!reader.next(event)) return 0;
  std::int64_t last_us = event.utime;
  int wrong = 0;
  for (bool more = true; more; std::swap(event, next)) {
    more = reader.next(next);
    const bool near_next = more && std::abs(next.utime - last_us) < kJump_us;
    if (std::abs(event.utime - last_us) > kJump_us && near_next) {
      event.utime = last_us;
      ++wrong;
    }
    last_us = event.utime;
    take(event);
  }
  return wrong;
}

int check(const Options& options) {
  std::map<std::string, std::int64_t> events;
  const int wrong_stamps = for_readable(options.log, [&](const modslam::LogEvent& event) { ++events[event.channel]; });
  for (const std::string& channel : options.needs)
    if (!events.count(channel)) throw std::runtime_error(options.log + ": holds no message on " + channel);
  std::cout << options.log << ":";
  for (const auto& [channel, count] : events) std::cout << " " << channel << " " << count;
  std::cout << std::endl;
  modslam::LogReader reader(options.log);
  for (modslam::LogEvent event; reader.next(event);) {
  }
  std::string damage = reader.damage();
  if (wrong_stamps > 0) damage += (damage.empty() ? "" : ", ") + std::to_string(wrong_stamps) + " events with wrong stamps";
  if (damage.empty()) return 0;
  std::cerr << options.log << ": is damaged: " << damage << std::endl;
  if (options.mended.empty()) return 2;
  modslam::LogWriter writer(options.mended);
  for_readable(options.log, [&](const modslam::LogEvent& event) {
    writer.write(event.utime, event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
  });
  writer.close();
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Says what an LCM log holds and where it is damaged");
  app.add_option("log", options.log, "the LCM log")->required();
  app.add_option("--needs", options.needs, "channel that must be in it; repeatable")->take_all()->expected(1);
  app.add_option("--mended", options.mended, "where a copy of what can be read goes when it is damaged");
  CLI11_PARSE(app, argc, argv);
  try {
    return check(options);
  } catch (const std::exception& error) {
    std::cerr << "check-log: " << error.what() << std::endl;
    return 1;
  }
}
