// SPDX-License-Identifier: BSD-3-Clause
/// procs/offline — all modules in one program on LCM's in-process bus: LOG in, DIR/run.lcm out.
/// As fast as the machine, and the same log and configuration give the same bytes, every time. What depends on the machine goes to
/// DIR/timing.js alone.
#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>

#include "procs/offline/offline_run.hpp"

namespace {
volatile std::sig_atomic_t stop_requested = 0;
}

int main(int argc, char** argv) {
  modslam::OfflineOptions options;
  options.config = "config/modslam.toml";
  CLI::App app("Runs the whole system over an LCM log, without a network");
  app.add_option("log", options.log, "LCM log with LASER and ODOMETRY")->required();
  app.add_option("--out", options.directory, "folder for the results")->required();
  app.add_option("--config", options.config, "configuration file")->capture_default_str();
  app.add_option("--set", options.overrides, "table.key=value, over the file; repeatable");
  CLI11_PARSE(app, argc, argv);
  const auto on_signal = [](int) { stop_requested = 1; };
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  try {
    return modslam::run_offline(options, [] { return stop_requested != 0; });
  } catch (const std::exception& error) {
    std::cerr << "offline: " << error.what() << std::endl;
    return 1;
  }
}
