// SPDX-License-Identifier: BSD-3-Clause
/// @file What happened over the time of a run, as SVG.
#pragma once
#include <string>

#include "procs/report/results.hpp"

namespace modslam::report {

/// Error of position and heading over time, ours and the odometry's; "" without ground truth.
std::string error_plots(const Results& results);

struct NamedResults {
  std::string name;
  const Results* results;  ///< with an error
};

/// Position and heading error of several runs over their time, each from its own first scan.
std::string compared_error_plots(const std::vector<NamedResults>& runs);

/// A strip of colours for the scan matcher, one for the estimator, and a mark for each loop
/// proposal.
std::string verdict_timeline(const RunRecord& run, const Results& results);

}  // namespace modslam::report
