// SPDX-License-Identifier: BSD-3-Clause
/// @file From a run's LCM log to the files of its folder.
#pragma once
#include <string>

namespace modslam::report {

struct ReportOptions {
  std::string folder;       ///< where the results go
  std::string log;          ///< "" = folder/run.lcm
  std::string world_truth;  ///< GeoJSON of the simulated world, or ""
};

/// Writes map.png, map.yaml, semantic.geojson, topology.json, path.tum, path_laser.tum, graph.g2o, summary.json
/// and report.html.
/// @return "" or what is wrong with the log, in words; the results are written all the same.
/// @throws std::runtime_error when the log cannot be read at all or a file cannot be written.
std::string write_report(const ReportOptions& options);

/// File name of the simulated world that the log speaks of (SIM_INFO); "" when it speaks of none.
/// @throws std::runtime_error when the log cannot be read at all.
std::string world_of(const ReportOptions& options);

/// The table for the terminal, from folder/summary.json. @throws std::runtime_error when it is
/// missing or broken.
std::string table_of(const std::string& folder);

}  // namespace modslam::report
