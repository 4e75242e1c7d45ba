// SPDX-License-Identifier: BSD-3-Clause
/// modslam-watchdog: supervisor's event listener. Ends a process that has said no STATUS for some seconds, so that supervisor starts it again.
///
/// It learns pids from supervisor (PROCESS_STATE events on stdin; http://supervisord.org/events.html) and signs of life from the bus. That
/// it listens has a second use: supervisor looks after a process that died as soon as it has an event to deliver, and not a second later.
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iostream>
#include <map>
#include <modslam/process_status_t.hpp>
#include <sstream>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"

namespace modslam {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// "key:value key:value ..." as supervisor writes it.
std::map<std::string, std::string> fields_of(const std::string& text) {
  std::map<std::string, std::string> fields;
  std::istringstream words(text);
  for (std::string word; words >> word;)
    if (const auto colon = word.find(':'); colon != std::string::npos) fields[word.substr(0, colon)] = word.substr(colon + 1);
  return fields;
}

/// The pid may belong to somebody else by now.
bool is_ours(pid_t pid) {
  std::string program;
  std::getline(std::ifstream("/proc/" + std::to_string(pid) + "/cmdline"), program, '\0');
  return program.find("modslam-") != std::string::npos;
}

class Watchdog {
 public:
  Watchdog(const std::string& url, double patience_s) : transport_(url), bus_(transport_, "watchdog"), patience_s_(patience_s) {
    bus_.subscribe<process_status_t>(channel::kStatus, [this](const process_status_t& m) {
      if (const auto life = lives_.find(m.name); life != lives_.end() && life->second.pid == m.pid) life->second.heard_s = now_s();
    });
  }

  /// Until supervisor closes the pipe.
  void run() {
    say("READY\n");
    while (read_events()) {
      while (transport_.poll(0)) {
      }
      end_who_hangs();
    }
  }

 private:
  struct Life {
    pid_t pid;
    double heard_s;
  };

  static void say(const char* words) { std::cout << words << std::flush; }

  /// Waits a moment for supervisor. @return false when it has gone.
  bool read_events() {
    pollfd waiting{STDIN_FILENO, POLLIN, 0};
    if (::poll(&waiting, 1, 100) < 1) return true;
    char bytes[4096];
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (count <= 0) return false;
    input_.append(bytes, static_cast<std::size_t>(count));
    for (std::size_t end; (end = input_.find('\n')) != std::string::npos;) {
      const auto header = fields_of(input_.substr(0, end));
      const auto length = header.count("len") ? std::strtoul(header.at("len").c_str(), nullptr, 10) : 0;
      if (input_.size() < end + 1 + length) break;
      if (header.count("eventname")) take(header.at("eventname"), fields_of(input_.substr(end + 1, length)));
      input_.erase(0, end + 1 + length);
      say("RESULT 2\nOKREADY\n");
    }
    return true;
  }

  void take(const std::string& event, std::map<std::string, std::string> fields) {
    if (fields["processname"] == "watchdog") return;
    if (event == "PROCESS_STATE_RUNNING") {
      lives_[fields["processname"]] = {static_cast<pid_t>(std::atoi(fields["pid"].c_str())), now_s()};
    } else {
      lives_.erase(fields["processname"]);
    }
  }

  void end_who_hangs() {
    for (auto life = lives_.begin(); life != lives_.end();) {
      const auto& [name, state] = *life;
      if (now_s() - state.heard_s < patience_s_ || !is_ours(state.pid)) {
        ++life;
        continue;
      }
      std::cerr << "watchdog: " << name << " has said nothing for " << patience_s_ << " s: ending it, so that it is started again" << std::endl;
      kill(state.pid, SIGKILL);
      life = lives_.erase(life);
    }
  }

  Transport transport_;
  Bus bus_;
  double patience_s_;
  std::map<std::string, Life> lives_;
  std::string input_;
};

}  // namespace
}  // namespace modslam

int main(int argc, char** argv) {
  std::string url;
  double patience_s = 5;
  CLI::App app("Supervisor's event listener: ends processes that hang");
  app.add_option("--url", url, "LCM url")->envname("LCM_DEFAULT_URL")->required();
  app.add_option("--patience", patience_s, "silence after which a process is ended [s]")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    modslam::Watchdog(url, patience_s).run();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "watchdog: " << error.what() << std::endl;
    return 1;
  }
}
