// SPDX-License-Identifier: BSD-3-Clause
/// @file Several runs on one page: their errors over time, what they cost, and which parameters
/// differ.
#pragma once
#include <string>
#include <vector>

namespace modslam::report {

/// @param folders  of runs; each holds a run.lcm.
/// @return the page; it needs nothing beside it.
/// @throws std::runtime_error naming the folder whose log cannot be read.
std::string comparison_page(const std::vector<std::string>& folders);

}  // namespace modslam::report
