// SPDX-License-Identifier: BSD-3-Clause
/// @file Hosts one module on the network: the whole main() of a process.
#pragma once
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/module.hpp"

namespace modslam {

/// Parses --config, --set, --url, checks multicast, runs the module until SIGINT or SIGTERM, publishes
/// STATUS each second and PARAMETERS at start. @return the process's exit code; errors go to stderr.
int run_process(int argc, char** argv, const std::string& name, ModuleFactory make_module);

/// Whether multicast of this machine reaches itself, within a second.
/// @return "" when all is well, else what is wrong and what to type.
std::string preflight(const std::string& url);

/// Publishes process_status_t for one module; keeps handler latencies of the last 1000 messages.
class StatusReporter {
 public:
  StatusReporter(Bus& bus, const Module& module);
  void add_latency(std::int64_t latency_us);
  /// `measured`: fill in what depends on the machine (pid, memory, latency); a reproducible run leaves it out.
  void publish(int state, bool measured);

 private:
  Bus& bus_;
  const Module& module_;
  std::vector<std::int64_t> latencies_us_;
  std::size_t next_ = 0;
};

}  // namespace modslam
