// SPDX-License-Identifier: BSD-3-Clause
/// modslam-watchdog: supervisor's event listener. Ends a process that has said no STATUS for some seconds, so that supervisor starts it again.
///
/// It learns pids from supervisor (PROCESS_STATE events on stdin; http://supervisord.org/events.html) and from the bus, and signs of life from
/// the bus. It also sees at once when a process has died; supervisor looks only once a second, so it is nudged: a connection to its
/// socket that says nothing wakes it.
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iostream>
#include <map>
#include <modslam/process_status_t.hpp>
#include <sstream>
#include <utility>
#include <vector>

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

/// The pid may belong to somebody else by now, or to another machine.
bool runs(const std::string& name, pid_t pid) {
  std::string program, wanted = "modslam-" + name;
  std::replace(wanted.begin(), wanted.end(), '_', '-');
  std::getline(std::ifstream("/proc/" + std::to_string(pid) + "/cmdline"), program, '\0');
  return program.size() >= wanted.size() && program.compare(program.size() - wanted.size(), wanted.size(), wanted) == 0;
}

/// Closes itself.
struct Descriptor {
  explicit Descriptor(int fd) : fd(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd(std::exchange(other.fd, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd, other.fd);
    return *this;
  }
  ~Descriptor() {
    if (fd >= 0) close(fd);
  }
  int fd;
};

class Watchdog {
 public:
  Watchdog(const std::string& url, double patience_s, std::string supervisor_socket)
      : transport_(url), bus_(transport_, "watchdog"), patience_s_(patience_s), supervisor_socket_(std::move(supervisor_socket)) {
    bus_.subscribe<process_status_t>(channel::kStatus, [this](const process_status_t& m) { heard(m.name, m.pid); });
  }

  /// Until supervisor closes the pipe.
  void run() {
    say("READY\n");
    while (wait_and_read()) {
      while (transport_.poll(0)) {
      }
      end_who_hangs();
      if (!nudges_s_.empty() && now_s() >= nudges_s_.front()) {
        nudges_s_.erase(nudges_s_.begin());
        nudge();
      }
    }
  }

 private:
  struct Life {
    pid_t pid;
    double heard_s;
    Descriptor process;  ///< becomes readable when it dies
  };

  static void say(const char* words) { std::cout << words << std::flush; }

  void heard(const std::string& name, pid_t pid) {
    if (name == "watchdog") return;
    const auto life = lives_.find(name);
    if (life != lives_.end() && life->second.pid == pid) {
      life->second.heard_s = now_s();
    } else if (runs(name, pid)) {
      lives_.insert_or_assign(name, Life{pid, now_s(), Descriptor(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)))});
    }
  }

  /// Waits a moment for supervisor's words and for deaths. @return false when supervisor has gone.
  bool wait_and_read() {
    std::vector<pollfd> waiting{{STDIN_FILENO, POLLIN, 0}};
    for (const auto& [name, life] : lives_) waiting.push_back({life.process.fd, POLLIN, 0});
    if (::poll(waiting.data(), waiting.size(), nudges_s_.empty() ? 100 : 10) < 1) return true;
    std::size_t k = 1;
    for (auto life = lives_.begin(); life != lives_.end(); ++k) {
      const bool died = waiting[k].revents != 0;
      if (died)
        for (const double delay_s : {0.01, 0.05, 0.15, 0.4}) nudges_s_.push_back(now_s() + delay_s);
      life = died ? lives_.erase(life) : std::next(life);
    }
    return waiting[0].revents == 0 || read_events();
  }

  bool read_events() {
    char bytes[4096];
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (count <= 0) return false;
    input_.append(bytes, static_cast<std::size_t>(count));
    for (std::size_t end; (end = input_.find('\n')) != std::string::npos;) {
      const auto header = fields_of(input_.substr(0, end));
      const auto length = header.count("len") ? std::strtoul(header.at("len").c_str(), nullptr, 10) : 0;
      if (input_.size() < end + 1 + length) break;
      auto fields = fields_of(input_.substr(end + 1, length));
      if (header.count("eventname") && header.at("eventname") == "PROCESS_STATE_RUNNING")
        heard(fields["processname"], static_cast<pid_t>(std::atoi(fields["pid"].c_str())));
      input_.erase(0, end + 1 + length);
      say("RESULT 2\nOKREADY\n");
    }
    return true;
  }

  void end_who_hangs() {
    for (auto& [name, life] : lives_) {
      if (now_s() - life.heard_s < patience_s_ || !runs(name, life.pid)) continue;
      std::cerr << "watchdog: " << name << " has said nothing for " << patience_s_ << " s: ending it, so that it is started again" << std::endl;
      kill(life.pid, SIGKILL);
      life.heard_s = now_s();
    }
  }

  void nudge() const {
    if (supervisor_socket_.empty()) return;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    supervisor_socket_.copy(address.sun_path, sizeof address.sun_path - 1);
    const Descriptor caller(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0));
    (void)connect(caller.fd, reinterpret_cast<sockaddr*>(&address), sizeof address);  // whether it succeeds changes nothing here
  }

  Transport transport_;
  Bus bus_;
  double patience_s_;
  std::string supervisor_socket_;
  std::map<std::string, Life> lives_;
  std::vector<double> nudges_s_;  ///< when to wake supervisor
  std::string input_;
};

}  // namespace
}  // namespace modslam

int main(int argc, char** argv) {
  std::string url, supervisor_socket;
  double patience_s = 5;
  CLI::App app("Supervisor's event listener: ends processes that hang");
  app.add_option("--url", url, "LCM url")->envname("LCM_DEFAULT_URL")->required();
  app.add_option("--patience", patience_s, "silence after which a process is ended [s]")->capture_default_str();
  app.add_option("--supervisor", supervisor_socket, "supervisor's unix socket");
  CLI11_PARSE(app, argc, argv);
  try {
    modslam::Watchdog(url, patience_s, supervisor_socket).run();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "watchdog: " << error.what() << std::endl;
    return 1;
  }
}
