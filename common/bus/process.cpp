// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/process.hpp"

#include <arpa/inet.h>
#include <malloc.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iostream>
#include <modslam/command_t.hpp>
#include <modslam/parameters_t.hpp>
#include <modslam/process_status_t.hpp>

#include "common/bus/catch_up.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/config.hpp"
#include "common/bus/loss_meter.hpp"
#include "common/bus/repeats.hpp"

namespace modslam {
namespace {

volatile std::sig_atomic_t stop_requested = 0;
void request_stop(int) { stop_requested = 1; }

std::int64_t steady_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::int64_t resident_kb() {
  long pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

/// A wild array length must end in bad_alloc, not in the machine's memory.
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit limit{rlim_t{4} << 30, rlim_t{4} << 30};
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

/// Large pieces go back to the machine when they are freed, instead of becoming holes among small ones: left to itself the C library moves
/// them into the heap after the first few.
void keep_large_pieces_out_of_the_heap() { mallopt(M_MMAP_THRESHOLD, 128 << 10); }

struct Options {
  std::string config = "config/modslam.toml";
  std::vector<std::string> overrides;
  std::string url;
};

/// Runs one module until a signal; see run_process.
class Host {
 public:
  Host(const std::string& name, const Options& options, ModuleFactory make_module)
      : config_(load_config(options.config, options.overrides)),
        transport_(options.url),
        bus_(transport_, name),
        repair_(bus_, [this](const repeat_request_t& request) { bus_.publish(channel::kRepeatRequest, request); }),
        module_(make_module(bus_, config_)),
        status_(bus_, *module_) {
    bus_.on_published = [this](const std::string& channel, const void* bytes, int size) { kept_.keep(channel, bytes, size); };
    bus_.on_bad = [this](const std::string& channel, const std::string& why) { say_bad(channel, why); };
    bus_.around_handler = [this](const std::function<void()>& handle) { time_handler(handle); };
    transport_.subscribe(channel::kStatus, [this](const std::string&, const void* bytes, int size) { on_status(bytes, size); });
    bus_.subscribe<repeat_request_t>(channel::kRepeatRequest, [this](const repeat_request_t& m) {
      for (repeat_t& answer : kept_.answer(m, steady_us())) {
        answer.utime = bus_.utime();
        bus_.publish(channel::kRepeat, answer);
      }
    });
    bus_.subscribe<repeat_t>(channel::kRepeat, [this](const repeat_t& m) { repair_.take(m); });
    bus_.subscribe<command_t>(channel::kCommand, [this](const command_t& m) { on_command(m); });
  }

  void run() {
    publish_parameters();
    status_.publish(state(), true);
    catch_up();
    while (!stop_requested) {
      transport_.poll(5);
      const std::int64_t now_us = steady_us();
      repair_.tick(now_us);
      module_->tick(now_us);
      if (now_us - last_trim_us_ >= kTrimEvery_us) give_memory_back(now_us);
      if (finish_by_us_ != 0 && ((module_->complete() && repair_.idle()) || now_us > finish_by_us_)) finish();
      if (delivered_until_us_ != 0 && now_us > delivered_until_us_) {
        bus_.forget_delivered();
        delivered_until_us_ = 0;
      }
      if (now_us - last_status_us_ >= 1'000'000 || state() != published_state_) {
        published_state_ = state();
        last_status_us_ = now_us;
        status_.publish(published_state_, true);
      }
    }
    status_.publish(process_status_t::STOPPED, true);
  }

 private:
  int state() const {
    if (module_->troubled()) return process_status_t::TROUBLED;
    return finished_ || module_->ended() ? process_status_t::FINISHED : process_status_t::RUNNING;
  }

  /// Who lost what: the counts of all others against our own.
  void on_status(const void* bytes, int size) {
    process_status_t status{};
    try {
      if (status.decode(bytes, 0, size) != size || status.name == bus_.name()) return;
    } catch (const std::exception&) {  // a wild array length
      return;
    }
    if (!transport_.is_lossless()) repair_.take(status);  // a gap behind a hub is the log's own
    for (const std::string& channel : losses_.take(status, bus_)) {
      repair_.suspect(channel);
      module_->missed(channel);
    }
  }

  void on_command(const command_t& command) {
    if (!command.target.empty() && command.target != bus_.name()) return;
    if (command.verb == "parameters") return publish_parameters();
    if (command.verb == "status") return status_.publish(state(), true);
    if (command.verb == "finish") return finish_soon();
    if (!module_->command(command.verb)) throw BadMessage("unknown verb '" + command.verb + "'");
    status_.publish(state(), true);
  }

  void finish_soon() {
    finish_by_us_ = steady_us() + kFinishPatience_us;
    finished_ = false;
  }

  void finish() {
    finish_by_us_ = 0;
    module_->finish();
    give_memory_back(steady_us());
    finished_ = true;
    status_.publish(state(), true);
  }

  /// What was freed goes back to the machine: neither a burst of messages nor the polish at the end leaves a mark. A few pages are
  /// asked for anew afterwards, which is why it is not done all the time.
  void give_memory_back(std::int64_t now_us) {
    malloc_trim(0);
    last_trim_us_ = now_us;
  }

  /// A module that goes on where an earlier life was killed gets what it missed, from the run's log.
  void catch_up() {
    const std::optional<Resumption> resumption = module_->resumption();
    if (!resumption) return;
    const Missed missed = read_missed(config_.recorder.path, *resumption, bus_.name(), getpid(), kCatchUpPatience_ms,
                                      [this] { status_.publish(state(), true); });
    for (const LogEvent& event : missed.events) bus_.deliver(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    delivered_until_us_ = steady_us() + kEchoes_us;
    std::cerr << bus_.name() << ": goes on after a restart; " << missed.events.size() << " messages since the last one were found in the log"
              << (missed.to_the_end ? "" : ", which does not reach up to now") << std::endl;
  }

  void publish_parameters() {
    parameters_t message{};
    message.utime = bus_.utime();
    message.name = bus_.name();
    message.toml = to_toml(config_, false);
    bus_.publish(channel::kParameters, message);
  }

  void time_handler(const std::function<void()>& handle) {
    const std::int64_t start_us = steady_us();
    handle();
    status_.add_latency(steady_us() - start_us);
  }

  void say_bad(const std::string& channel, const std::string& why) {
    const std::int64_t now_us = steady_us();
    if (now_us - last_bad_us_ < 1'000'000) return;
    last_bad_us_ = now_us;
    std::cerr << bus_.name() << ": dropped a message on " << channel << ": " << why << std::endl;
  }

  SystemConfig config_;
  Transport transport_;
  Bus bus_;
  KeptMessages kept_;
  StreamRepair repair_;
  std::unique_ptr<Module> module_;
  StatusReporter status_;
  LossMeter losses_;
  static constexpr std::int64_t kFinishPatience_us = 10'000'000, kEchoes_us = 5'000'000, kTrimEvery_us = 10'000'000;
  static constexpr int kCatchUpPatience_ms = 1500;
  bool finished_ = false;
  std::int64_t finish_by_us_ = 0;       ///< not 0: told to finish, waits for what is missing
  std::int64_t delivered_until_us_ = 0;  ///< not 0: messages from the log may come a second time
  int published_state_ = -1;
  std::int64_t last_status_us_ = 0, last_bad_us_ = 0, last_trim_us_ = 0;
};

}  // namespace

StatusReporter::StatusReporter(Bus& bus, const Module& module) : bus_(bus), module_(module) {}

void StatusReporter::add_latency(std::int64_t latency_us) {
  constexpr std::size_t kKept = 1000;
  if (latencies_us_.size() < kKept) return latencies_us_.push_back(latency_us);
  latencies_us_[next_++ % kKept] = latency_us;
}

void StatusReporter::publish(int state, bool measured) {
  const auto counts = [](const std::map<std::string, ChannelCount>& from) {
    std::vector<channel_count_t> list;
    for (const auto& [name, count] : from) {
      channel_count_t c{};
      c.channel = name;
      c.received = count.received;
      c.bad = count.bad;
      c.gaps = std::max(count.gaps, count.lost);
      list.push_back(c);
    }
    return list;
  };
  process_status_t message{};
  message.utime = bus_.utime();
  message.name = bus_.name();
  message.version = MODSLAM_VERSION;
  message.state = static_cast<std::int8_t>(state);
  message.inputs = counts(bus_.inputs());
  message.ninputs = static_cast<std::int32_t>(message.inputs.size());
  message.outputs = counts(bus_.outputs());
  message.noutputs = static_cast<std::int32_t>(message.outputs.size());
  message.words = module_.words();
  if (measured) {
    message.pid = getpid();
    message.memory_kb = resident_kb();
    std::vector<std::int64_t> sorted = latencies_us_;
    std::sort(sorted.begin(), sorted.end());
    if (!sorted.empty()) {
      message.latency_p50_us = sorted[sorted.size() / 2];
      message.latency_p99_us = sorted[sorted.size() * 99 / 100];
    }
  }
  bus_.publish(channel::kStatus, message);
}

std::string preflight(const std::string& url) {
  if (url.rfind("udpm", 0) != 0) return "";
  const std::string cure =
      "; as root type: ip link set lo up && ip route add 224.0.0.0/4 dev lo"
      "  (without root: unshare -rn sh, then the same two commands inside)";
  const int receiver = socket(AF_INET, SOCK_DGRAM, 0), sender = socket(AF_INET, SOCK_DGRAM, 0);
  std::string trouble;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = INADDR_ANY;
  socklen_t length = sizeof address;
  ip_mreq group{};
  group.imr_multiaddr.s_addr = inet_addr("239.255.76.67");
  if (bind(receiver, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &length) != 0) {
    trouble = std::string("cannot open a UDP socket: ") + std::strerror(errno);
  } else if (setsockopt(receiver, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0) {
    trouble = "this machine has no multicast route" + cure;
  } else {
    const unsigned char ttl = 0;
    setsockopt(sender, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
    address.sin_addr = group.imr_multiaddr;
    if (sendto(sender, "?", 1, 0, reinterpret_cast<sockaddr*>(&address), sizeof address) != 1) {
      trouble = "this machine has no multicast route" + cure;
    } else {
      pollfd waiting{receiver, POLLIN, 0};
      if (::poll(&waiting, 1, 1000) != 1)
        trouble = "multicast is sent but does not come back; is a firewall in the way?" + cure;
    }
  }
  close(receiver);
  close(sender);
  return trouble;
}

int run_process(int argc, char** argv, const std::string& name, ModuleFactory make_module) {
  Options options;
  CLI::App app("ModSLAM process " + name + ", version " MODSLAM_VERSION);
  app.add_option("--config", options.config, "configuration file")->capture_default_str();
  app.add_option("--set", options.overrides, "table.key=value, over the file; repeatable");
  app.add_option("--url", options.url, "LCM url; default: LCM_DEFAULT_URL, else ttl 0 multicast")
      ->envname("LCM_DEFAULT_URL");
  CLI11_PARSE(app, argc, argv);
  if (options.url.empty()) options.url = "udpm://239.255.76.67:7667?ttl=0";
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  limit_memory();
  keep_large_pieces_out_of_the_heap();
  try {
    if (const std::string trouble = preflight(options.url); !trouble.empty())
      throw std::runtime_error(trouble);
    Host(name, options, make_module).run();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << std::endl;
    return 1;
  }
}

}  // namespace modslam
