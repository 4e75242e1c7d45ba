// SPDX-License-Identifier: BSD-3-Clause
/// @file report.html: one page that needs nothing beside it (timing.js is welcome).
#pragma once
#include <string>

#include "procs/report/map_view.hpp"
#include "procs/report/summary.hpp"

namespace modslam::report {

std::string report_page(const RunRecord& run, const Results& results, const Json& summary,
                        const WorldOutline* world);

/// The constant parts of the page.
extern const char* const kPageStyle;
extern const char* const kPageScript;

}  // namespace modslam::report
