// SPDX-License-Identifier: BSD-3-Clause
/// modslam-check-log: says what an LCM log holds and where it is damaged, and copies what can be read.
/// Exit code 0: whole; 1: no log, or without a channel that is needed; 2: damaged.
#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "common/bus/log.hpp"

namespace {

struct Options {
  std::string log, mended;
  std::vector<std::string> needs;
};

void copy_readable(const std::string& from, const std::string& to) {
  modslam::LogReader reader(from);
  modslam::LogWriter writer(to);
  for (modslam::LogEvent event; reader.next(event);)
    writer.write(event.utime, event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
  writer.close();
}

int check(const Options& options) {
  modslam::LogReader reader(options.log);
  std::map<std::string, std::int64_t> events;
  for (modslam::LogEvent event; reader.next(event);) ++events[event.channel];
  for (const std::string& channel : options.needs)
    if (!events.count(channel)) throw std::runtime_error(options.log + ": holds no message on " + channel);
  std::cout << options.log << ":";
  for (const auto& [channel, count] : events) std::cout << " " << channel << " " << count;
  std::cout << std::endl;
  const std::string damage = reader.damage();
  if (damage.empty()) return 0;
  std::cerr << options.log << ": is damaged: " << damage << std::endl;
  if (!options.mended.empty()) copy_readable(options.log, options.mended);
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
