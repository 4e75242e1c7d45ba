// SPDX-License-Identifier: BSD-3-Clause
/// @file The table that `run.sh status` prints.
#pragma once
#include <map>
#include <modslam/process_status_t.hpp>
#include <ostream>
#include <string>
#include <vector>

namespace modslam {

/// The first and the newest STATUS of a process while somebody listened.
struct Heard {
  process_status_t first, status;
  double first_s = 0, at_s = 0;
  int count = 0;
};

/// How often supervisor has started each process again, from its log.
std::map<std::string, int> count_restarts(const std::string& supervisor_log);

/// @param expected processes that should speak; those that do not are shown as SILENT.
/// @return whether all is well: everybody expected speaks, nobody is in trouble.
bool print_status_table(std::ostream& out, const std::map<std::string, Heard>& heard, const std::vector<std::string>& expected,
                        const std::map<std::string, int>& restarts);

}  // namespace modslam
