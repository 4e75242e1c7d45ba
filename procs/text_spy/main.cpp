// SPDX-License-Identifier: BSD-3-Clause
/// modslam-text-spy: what passes on the bus, in a terminal: rates, bandwidth, gaps, and the newest
/// message of a chosen channel. Keys: up and down (or k and j) choose, q ends. With --once it
/// listens for a moment and prints plain text.
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <iostream>

#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "procs/text_spy/decode.hpp"
#include "procs/text_spy/traffic.hpp"

namespace modslam {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The terminal gives keys at once and is as it was afterwards.
class RawTerminal {
 public:
  RawTerminal() {
    tcgetattr(STDIN_FILENO, &before_);
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    std::cout << "\x1b[?1049h\x1b[?25l" << std::flush;
  }
  ~RawTerminal() {
    std::cout << "\x1b[?25h\x1b[?1049l" << std::flush;
    tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// 'u' and 'd' for up and down, other keys as they are, 0 for none.
  static char key() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char c[3] = {};
    if (::poll(&input, 1, 0) != 1) return 0;
    const ssize_t n = read(STDIN_FILENO, c, sizeof c);
    if (n == 3 && c[0] == '\x1b') return c[2] == 'A' ? 'u' : c[2] == 'B' ? 'd' : '\0';
    return c[0] == 'k' ? 'u' : c[0] == 'j' ? 'd' : n < 1 ? 'q' : c[0];
  }
  static int rows() {
    winsize size{};
    return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 ? size.ws_row : 24;
  }
  static int columns() {
    winsize size{};
    return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
  }

 private:
  termios before_{};
};

class TextSpy {
 public:
  explicit TextSpy(const std::string& url) : transport_(url) {
    transport_.subscribe(".*", [this](const std::string& channel, const void* bytes, int size) {
      if (channel == "LCM_SELF_TEST") return;
      traffic_.add(channel, bytes, static_cast<std::size_t>(size), now_s(),
                   message_number(channel, bytes, static_cast<std::size_t>(size)));
    });
  }

  void listen(double seconds) {
    const double end = now_s() + seconds;
    while (!stop_requested && now_s() < end) transport_.poll(20);
  }
  void choose(int step) {
    chosen_ = std::clamp(chosen_ + step, 0,
                         std::max(0, static_cast<int>(traffic_.channels().size()) - 1));
  }
  void choose(const std::string& channel) {
    int i = 0;
    for (const auto& [name, c] : traffic_.channels()) {
      if (name == channel) chosen_ = i;
      ++i;
    }
  }

  std::vector<std::string> lines() const {
    const double now = now_s();
    std::vector<std::string> all;
    char text[200];
    double bandwidth = 0;
    std::snprintf(text, sizeof text, "  %-22s %9s %9s %10s %8s %9s", "channel", "messages", "per s",
                  "kB per s", "missing", "silent s");
    all.push_back(text);
    int i = 0;
    const ChannelTraffic* shown = nullptr;
    std::string shown_name;
    for (const auto& [name, c] : traffic_.channels()) {
      const auto [rate_hz, bytes_per_s] = Traffic::rate(c, now);
      bandwidth += bytes_per_s;
      std::string plain = name;
      for (char& letter : plain)
        if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f) letter = '?';
      std::snprintf(text, sizeof text, "%c %-22s %9lld %9.1f %10.2f %8s %9.1f",
                    i == chosen_ ? '>' : ' ', plain.c_str(), static_cast<long long>(c.messages),
                    rate_hz, bytes_per_s / 1000,
                    c.last_number < 0 ? "-" : std::to_string(c.missing).c_str(), now - c.last_s);
      all.push_back(text);
      if (i++ == chosen_) shown = &c, shown_name = plain;
    }
    std::snprintf(text, sizeof text, "%d channels, %.1f kB a second", i, bandwidth / 1000);
    all.insert(all.begin(), text);
    if (!shown) return all;
    all.push_back("");
    all.push_back(shown_name + ", newest message:");
    for (const std::string& field : describe_message(shown_name, shown->newest))
      all.push_back("  " + field);
    return all;
  }

 private:
  Transport transport_;
  Traffic traffic_;
  int chosen_ = 0;
};

void show(const TextSpy& spy) {
  std::string screen = "\x1b[H";
  const auto columns = static_cast<std::size_t>(RawTerminal::columns());
  int left = RawTerminal::rows() - 1;
  for (const std::string& line : spy.lines()) {
    if (left-- <= 0) break;
    screen += line.substr(0, columns) + "\x1b[K\r\n";
  }
  std::cout << screen << "\x1b[J"
            << "up, down: channel   q: end" << std::flush;
}

int watch(TextSpy& spy) {
  const RawTerminal terminal;
  while (!stop_requested) {
    spy.listen(0.1);
    for (char key; (key = RawTerminal::key()) != 0;) {
      if (key == 'q') return 0;
      spy.choose(key == 'u' ? -1 : key == 'd' ? 1 : 0);
    }
    show(spy);
  }
  return 0;
}

}  // namespace
}  // namespace modslam

int main(int argc, char** argv) {
  std::string url = "udpm://239.255.76.67:7667?ttl=0", channel;
  double once_s = 0;
  CLI::App app("What passes on the bus, in a terminal.");
  app.add_option("--url", url, "LCM url")->envname("LCM_DEFAULT_URL")->capture_default_str();
  app.add_option("--channel", channel, "show this one's newest message");
  app.add_option("--once", once_s, "listen for so many seconds, print, end")
      ->check(CLI::Range(0.1, 3600.0));
  CLI11_PARSE(app, argc, argv);
  const auto stop = [](int) { modslam::stop_requested = 1; };
  std::signal(SIGINT, stop);
  std::signal(SIGTERM, stop);
  try {
    if (const std::string trouble = modslam::preflight(url); !trouble.empty())
      throw std::runtime_error(trouble);
    modslam::TextSpy spy(url);
    if (once_s == 0 && isatty(STDIN_FILENO) && isatty(STDOUT_FILENO)) {
      spy.listen(0.3);
      spy.choose(channel);
      return modslam::watch(spy);
    }
    spy.listen(once_s > 0 ? once_s : 3);
    spy.choose(channel);
    for (const std::string& line : spy.lines()) std::cout << line << '\n';
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "text-spy: " << error.what() << std::endl;
    return 1;
  }
}
