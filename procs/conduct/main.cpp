// SPDX-License-Identifier: BSD-3-Clause
/// modslam-conduct: what a launcher needs to know of a running system, over the bus: STATUS in, COMMAND out.
///   up NAME...      waits until each process has spoken
///   ended NAME      waits until that process says FINISHED (a simulated route has ended)
///   settle NAME...  tells each in turn that the input has ended and waits for its FINISHED
///   tell NAME VERB  says a verb to a process and prints the words of its next STATUS
///   status NAME...  listens for a moment and prints a table; exit code 1 when somebody is in trouble or silent
/// A COMMAND stands in each process's queue behind the messages sent before it, so FINISHED means: all of those are handled.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <map>
#include <modslam/command_t.hpp>
#include <modslam/process_status_t.hpp>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/process.hpp"
#include "procs/conduct/status_table.hpp"

namespace modslam {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

constexpr double kQuiet_s = 0.25;  // between two words of a process that may still get something
constexpr int kQuietWords = 3;     // that tell of nothing new

class Conductor {
 public:
  explicit Conductor(const std::string& url) : transport_(url), bus_(transport_, "conduct") {
    bus_.subscribe<process_status_t>(channel::kStatus, [this](const process_status_t& m) {
      Heard& heard = heard_[m.name];
      if (heard.count++ == 0 || heard.status.pid != m.pid) {
        heard.first = m;
        heard.first_s = now_s();
      }
      heard.status = m;
      heard.at_s = now_s();
    });
  }

  /// @return false when `seconds` passed before `done` was true.
  template <class Done>
  bool wait(double seconds, Done done) {
    const double end = now_s() + seconds;
    while (!done()) {
      if (now_s() > end) return false;
      transport_.poll(20);
    }
    return true;
  }

  bool up(const std::vector<std::string>& names, double seconds) {
    const bool all = wait(seconds, [&] {
      return std::all_of(names.begin(), names.end(), [&](const auto& name) { return heard_.count(name) > 0; });
    });
    for (const auto& name : names)
      if (!heard_.count(name)) std::cerr << name << " has not spoken within " << seconds << " s" << std::endl;
    // Who started early spoke of its parameters when nobody recorded yet.
    command_t command{};
    command.verb = "parameters";
    bus_.publish(channel::kCommand, command);
    return all;
  }

  bool ended(const std::string& name, double seconds) {
    return wait(seconds, [&] {
      const auto heard = heard_.find(name);
      return heard != heard_.end() && heard->second.status.state == process_status_t::FINISHED;
    });
  }

  /// Until the process has got nothing new for a while: behind a TCP hub a command overtakes what others have sent.
  void drain(const std::string& name, double seconds) {
    const auto received = [&] {
      std::int64_t sum = 0;
      const auto heard = heard_.find(name);
      if (heard == heard_.end()) return sum;
      for (const channel_count_t& in : heard->second.status.inputs)
        if (in.channel != channel::kStatus && in.channel != channel::kCommand) sum += in.received;
      return sum;
    };
    const double end = now_s() + seconds;
    std::int64_t last = -1;
    for (int same = 0; same < kQuietWords && now_s() < end;) {
      const int count = heard_[name].count;
      say(name, "status");
      const bool spoke = wait(2.0, [&] { return heard_[name].count > count; });
      same = spoke && received() == last ? same + 1 : 0;
      last = received();
      wait(kQuiet_s, [] { return false; });
    }
  }

  bool settle(const std::string& name, double seconds, bool drained) {
    if (drained) drain(name, seconds);
    const double end = now_s() + seconds;
    while (now_s() < end) {  // a command may be lost too: say it again every five seconds
      heard_.erase(name);
      say(name, "finish");
      const bool spoke = wait(std::min(5.0, end - now_s()), [&] {
        const auto heard = heard_.find(name);
        return heard != heard_.end() && heard->second.status.state >= process_status_t::TROUBLED;
      });
      if (!spoke) continue;
      const process_status_t& status = heard_[name].status;
      if (status.state == process_status_t::FINISHED) return true;
      std::cerr << name << " cannot finish: " << status.words << std::endl;
      return false;
    }
    std::cerr << name << " has not finished within " << seconds << " s" << std::endl;
    return false;
  }

  bool tell(const std::string& name, const std::string& verb, double seconds) {
    if (!up({name}, seconds)) return false;
    const int count = heard_[name].count;
    say(name, verb);
    // Regular words come once a second; the answer is one that was spoken after the command's handler ended.
    if (!wait(seconds, [&] { return heard_[name].count > count + 1; })) return false;
    std::cout << name << ": " << heard_[name].status.words << std::endl;
    return true;
  }

  int print_status(double seconds, const std::vector<std::string>& expected, const std::string& supervisor_log) {
    wait(seconds, [] { return false; });
    if (heard_.empty()) {
      std::cerr << "no process has spoken within " << seconds << " s: is a run going on?" << std::endl;
      return 1;
    }
    return print_status_table(std::cout, heard_, expected, count_restarts(supervisor_log)) ? 0 : 1;
  }

 private:
  void say(const std::string& name, const std::string& verb) {
    command_t command{};
    command.target = name;
    command.verb = verb;
    bus_.publish(channel::kCommand, command);
  }

  Transport transport_;
  Bus bus_;
  std::map<std::string, Heard> heard_;
};

}  // namespace
}  // namespace modslam

int main(int argc, char** argv) {
  std::string url, supervisor_log, told, verb;
  double seconds = 60;
  bool drained = false;
  std::vector<std::string> names;
  CLI::App app("Waits for, settles and lists the processes of a run");
  app.add_option("--url", url, "LCM url")->envname("LCM_DEFAULT_URL")->required();
  app.add_option("--timeout", seconds, "how long to wait [s]")->capture_default_str();
  auto* up = app.add_subcommand("up", "wait until each process has spoken");
  up->add_option("names", names)->required();
  auto* ended = app.add_subcommand("ended", "wait until a process says FINISHED");
  ended->add_option("names", names)->required();
  auto* settle = app.add_subcommand("settle", "tell each in turn that the input has ended");
  settle->add_option("names", names)->required();
  settle->add_flag("--drain", drained, "first wait until it gets nothing new");
  auto* tell = app.add_subcommand("tell", "say a verb to one process");
  tell->add_option("name", told)->required();
  tell->add_option("verb", verb)->required();
  auto* status = app.add_subcommand("status", "print a table");
  status->add_option("names", names, "processes that should speak");
  status->add_option("--supervisor-log", supervisor_log, "to count restarts in");
  app.require_subcommand(1);
  CLI11_PARSE(app, argc, argv);
  try {
    if (const std::string trouble = modslam::preflight(url); !trouble.empty()) throw std::runtime_error(trouble);
    modslam::Conductor conductor(url);
    if (*up) return conductor.up(names, seconds) ? 0 : 1;
    if (*tell) return conductor.tell(told, verb, seconds) ? 0 : 1;
    if (*ended) return conductor.ended(names.front(), seconds) ? 0 : 1;
    if (*status) return conductor.print_status(std::min(seconds, 2.4), names, supervisor_log);
    for (const std::string& name : names)
      if (!conductor.settle(name, seconds, drained)) return 1;
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "conduct: " << error.what() << std::endl;
    return 1;
  }
}
