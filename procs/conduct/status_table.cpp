// SPDX-License-Identifier: BSD-3-Clause
#include "procs/conduct/status_table.hpp"

#include <fstream>
#include <iomanip>

namespace modslam {
namespace {

std::int64_t received(const process_status_t& status) {
  std::int64_t sum = 0;
  for (const channel_count_t& in : status.inputs) sum += in.received;
  return sum;
}

const char* state_name(int state) {
  static const char* const kStates[] = {"?", "running", "TROUBLE", "finished", "stopped"};
  return state >= 0 && state <= 4 ? kStates[state] : "?";
}

void print_row(std::ostream& out, const std::string& name, const Heard& heard, int restarts) {
  const process_status_t& s = heard.status;
  std::int64_t bad = 0, lost = 0;
  for (const channel_count_t& in : s.inputs) bad += in.bad, lost += in.gaps;
  const double span_s = heard.at_s - heard.first_s;
  const double rate_hz = span_s > 0 ? static_cast<double>(received(s) - received(heard.first)) / span_s : 0;
  out << std::left << std::setw(21) << name << std::setw(9) << state_name(s.state) << std::right << std::setw(8) << s.pid << std::setw(9)
      << restarts << std::setw(10) << received(s) << std::fixed << std::setprecision(0) << std::setw(8) << rate_hz << std::setw(6) << bad
      << std::setw(6) << lost << std::setprecision(2) << std::setw(9) << 1e-3 * static_cast<double>(s.latency_p50_us) << std::setw(9)
      << 1e-3 * static_cast<double>(s.latency_p99_us) << std::setw(7) << std::setprecision(1) << static_cast<double>(s.memory_kb) / 1024 << "  "
      << s.words << "\n";
}

}  // namespace

std::map<std::string, int> count_restarts(const std::string& supervisor_log) {
  std::map<std::string, int> restarts;
  std::ifstream log(supervisor_log);
  for (std::string line; std::getline(log, line);) {
    const auto spawned = line.find("spawned: '");
    if (spawned == std::string::npos) continue;
    const auto name = spawned + 10;
    ++restarts[line.substr(name, line.find('\'', name) - name)];
  }
  for (auto& [name, starts] : restarts) --starts;
  return restarts;
}

bool print_status_table(std::ostream& out, const std::map<std::string, Heard>& heard, const std::vector<std::string>& expected,
                        const std::map<std::string, int>& restarts) {
  bool well = true;
  const auto restarts_of = [&](const std::string& name) {
    const auto found = restarts.find(name);
    return found == restarts.end() ? 0 : found->second;
  };
  out << "process              state         pid restarts        in    in/s   bad  lost   p50 ms   p99 ms     MB  what it says\n";
  for (const auto& [name, one] : heard) {
    print_row(out, name, one, restarts_of(name));
    well = well && one.status.state != process_status_t::TROUBLED;
  }
  for (const std::string& name : expected) {
    if (heard.count(name)) continue;
    out << std::left << std::setw(21) << name << "SILENT" << std::right << std::setw(20) << restarts_of(name) << "\n";
    well = false;
  }
  return well;
}

}  // namespace modslam
