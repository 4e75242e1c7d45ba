// SPDX-License-Identifier: BSD-3-Clause
/// @file summary.json: the figures of a run, for machines and for the table in the terminal.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "procs/report/results.hpp"

namespace modslam::report {

using Json = nlohmann::ordered_json;

/// Only what the log's messages decide: no clock, no path, no latency. The same log gives the same
/// bytes.
Json summarise(const RunRecord& run, const Results& results);

/// A few lines for people. `folder` is where the results are.
std::string terminal_table(const Json& summary, const std::string& folder);

}  // namespace modslam::report
