// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace modslam {

struct OfflineOptions {
  std::string log, directory, config;
  std::vector<std::string> overrides;
};

/// Writes directory/run.lcm and directory/timing.js. @return 0, or 2 when the log was damaged (what was readable is in the result), or
/// 130 when stopped half-way. @throws std::runtime_error naming what is missing.
int run_offline(const OfflineOptions& options, const std::function<bool()>& stop_requested);

}  // namespace modslam
