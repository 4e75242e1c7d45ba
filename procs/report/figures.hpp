// SPDX-License-Identifier: BSD-3-Clause
/// @file Figures of the report as files of their own, for papers.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "procs/report/results.hpp"

namespace modslam::report {

/// The pictures in a piece of the page, each from <svg to </svg>.
std::vector<std::string> pictures_in(const std::string& html);

/// A picture that needs no page: with its size, and the page's light colours inside.
std::string standalone(const std::string& svg);

/// Names (map, error_position, error_heading, verdicts) and SVG of what the run has to show.
std::vector<std::pair<std::string, std::string>> figures_of(const RunRecord& run,
                                                            const Results& results);

}  // namespace modslam::report
