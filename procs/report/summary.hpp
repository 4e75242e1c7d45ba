// SPDX-License-Identifier: BSD-3-Clause
/// @file summary.json: the figures of a run, for machines and for the table in the terminal.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "procs/report/results.hpp"

namespace modslam::report {

using Json = nlohmann::ordered_json;

/// Only what the log's messages decide: no clock, no path, no latency. The same log gives the same
/// bytes.
Json summarise(const RunRecord& run, const Results& results);

/// Rows "kind, found, visible in the run, precision, recall" of a summary's semantic scores, as
/// text.
/// @param wall_tolerance_m  only the walls' row of this tolerance; 0: all.
std::vector<std::vector<std::string>> score_rows(const Json& semantic_scores,
                                                 double wall_tolerance_m = 0);

/// A few lines for people. `folder` is where the results are.
std::string terminal_table(const Json& summary, const std::string& folder);

}  // namespace modslam::report
