// SPDX-License-Identifier: BSD-3-Clause
/// @file The semantic map against the true world of a simulated run.
#pragma once
#include <string>

#include "procs/report/summary.hpp"

namespace modslam::report {

/// Scores of walls, rooms and doors over what the run could see (common/evaluation has the
/// definitions). Null when the log holds no ground truth to place the world by.
/// @throws std::runtime_error naming the file that cannot be read.
Json score_world(const std::string& world_path, const std::string& log_path, const RunRecord& run,
                 const Results& results);

}  // namespace modslam::report
