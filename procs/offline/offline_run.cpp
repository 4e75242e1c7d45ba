// SPDX-License-Identifier: BSD-3-Clause
#include "procs/offline/offline_run.hpp"

#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <modslam/parameters_t.hpp>
#include <modslam/process_status_t.hpp>
#include <set>

#include "common/bus/channels.hpp"
#include "common/bus/config.hpp"
#include "common/bus/log.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/process.hpp"

namespace modslam {
namespace {

/// What a log may feed in; everything else in it is a result of some earlier run.
const std::set<std::string> kInputChannels(std::begin(channel::from_logs), std::end(channel::from_logs));

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// CPU time of this thread, finer than cpu_s().
double thread_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

long peak_memory_kb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

/// One module with its own view of the bus and the time its handlers took.
struct Hosted {
  Hosted(Transport& transport, const std::string& name, ModuleFactory make, const SystemConfig& config)
      : bus(transport, name), module(make(bus, config)), status(bus, *module) {
    bus.around_handler = [this](const std::function<void()>& handle) {
      const double start = now_s();
      handle();
      seconds += now_s() - start;
    };
    bus.on_bad = [this](const std::string& channel, const std::string& why) {
      if (bad++ < 5) std::cerr << bus.name() << ": dropped a message on " << channel << ": " << why << std::endl;
    };
  }
  Bus bus;
  std::unique_ptr<Module> module;
  StatusReporter status;
  double seconds = 0;
  int bad = 0;
};

class OfflineRun {
 public:
  OfflineRun(const SystemConfig& config, const std::string& directory)
      : directory_(directory), transport_("memq://"), recorder_(directory + "/run.lcm"), host_bus_(transport_, "offline") {
    // The recorder subscribes first, so that a message stands in the log before its consequences.
    transport_.subscribe(".*", [this](const std::string& channel, const void* bytes, int size) {
      recorder_.write(utime_, channel, bytes, size);
    });
    host("scan_matcher", make_scan_matcher, config);
    if (config.launch.estimator == "graph_optimizer") {
      host("graph_optimizer", make_graph_optimizer, config);
      if (config.launch.loops) host("loop_detector", make_loop_detector, config);
    } else {
      host("yardstick", make_yardstick, config);
    }
    host("map_builder", make_map_builder, config);
    if (config.launch.semantics) host("semantic_classifier", make_semantic_classifier, config);
    parameters_.name = "offline";
    parameters_.toml = to_toml(config, false);
  }

  void feed(const LogEvent& event) {
    if (first_utime_ == 0) {
      first_utime_ = utime_ = event.utime;
      host_bus_.publish(channel::kParameters, parameters_);
    }
    utime_ = event.utime;
    if (event.channel == channel::kLaser) {
      const double now = thread_s();
      if (scans_++ > 0) scan_ms_.push_back(static_cast<float>(1e3 * (now - scan_start_s_)));
      scan_start_s_ = now;
    }
    transport_.publish(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    drain();
    for (auto& hosted : modules_) hosted->module->tick(utime_);
    drain();
  }

  void finish() {
    for (auto& hosted : modules_) {
      hosted->module->finish();
      drain();
    }
    for (auto& hosted : modules_) hosted->status.publish(process_status_t::FINISHED, false);
    drain();
    recorder_.close();
  }

  std::int64_t scans() const { return scans_; }
  double sensor_s() const { return 1e-6 * static_cast<double>(utime_ - first_utime_); }

  void write_timing(double wall_s, double used_cpu_s) const {
    std::ofstream out(directory_ + "/timing.js");
    out << std::fixed << std::setprecision(3) << "modslam_timing({\"host\": \"offline\", \"wall_s\": " << wall_s
        << ", \"cpu_s\": " << used_cpu_s << ", \"sensor_s\": " << sensor_s()
        << ", \"times_real_time\": " << (used_cpu_s > 0 ? sensor_s() / used_cpu_s : 0.0) << ", \"scans\": " << scans_
        << ", \"scan_ms\": {\"p50\": " << scan_ms(0.5) << ", \"p99\": " << scan_ms(0.99) << ", \"max\": " << scan_ms(1.0) << "}"
        << ", \"peak_memory_mb\": " << static_cast<double>(peak_memory_kb()) / 1024.0 << ", \"modules\": {";
    for (std::size_t k = 0; k < modules_.size(); ++k)
      out << (k ? ", " : "") << "\"" << modules_[k]->bus.name() << "\": {\"cpu_s\": " << modules_[k]->seconds
          << ", \"ms_per_scan\": " << (scans_ ? 1e3 * modules_[k]->seconds / static_cast<double>(scans_) : 0.0) << "}";
    out << "}});\n";
  }

  void say_modules() const {
    for (const auto& hosted : modules_)
      std::cout << "  " << std::left << std::setw(20) << hosted->bus.name() << hosted->module->words() << "\n";
  }

 private:
  /// CPU time from one scan to the next, all modules: the share `q` of scans took no longer.
  double scan_ms(double q) const {
    if (scan_ms_.empty()) return 0;
    std::vector<float> sorted = scan_ms_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(q * static_cast<double>(sorted.size())))];
  }
  void host(const std::string& name, ModuleFactory make, const SystemConfig& config) {
    modules_.push_back(std::make_unique<Hosted>(transport_, name, make, config));
  }
  void drain() {
    while (transport_.poll(0)) {
    }
  }

  std::string directory_;
  Transport transport_;
  LogWriter recorder_;
  Bus host_bus_;
  std::vector<std::unique_ptr<Hosted>> modules_;
  parameters_t parameters_{};
  std::int64_t utime_ = 0, first_utime_ = 0, scans_ = 0;
  std::vector<float> scan_ms_;
  double scan_start_s_ = 0;
};

}  // namespace

int run_offline(const OfflineOptions& options, const std::function<bool()>& stop_requested) {
  const SystemConfig config = load_config(options.config, options.overrides);
  LogReader reader(options.log);
  std::error_code error;
  std::filesystem::create_directories(options.directory, error);
  if (error) throw std::runtime_error(options.directory + ": cannot be made: " + error.message());
  const double start = now_s();
  OfflineRun run(config, options.directory);
  LogEvent event;
  bool stopped = false;
  while (!(stopped = stop_requested()) && reader.next(event))
    if (kInputChannels.count(event.channel)) run.feed(event);
  if (run.scans() == 0) throw std::runtime_error(options.log + ": holds no message on LASER");
  run.finish();
  const double wall_s = now_s() - start, used_cpu_s = cpu_s();
  run.write_timing(wall_s, used_cpu_s);
  std::cout << run.scans() << " scans, " << std::fixed << std::setprecision(1) << run.sensor_s() << " s of sensor time in "
            << used_cpu_s << " s of CPU: " << run.sensor_s() / used_cpu_s << " times real time\n";
  run.say_modules();
  if (const std::string damage = reader.damage(); !damage.empty()) {
    std::cerr << options.log << ": " << damage << std::endl;
    return 2;
  }
  return stopped ? 130 : 0;
}

}  // namespace modslam
