// SPDX-License-Identifier: BSD-3-Clause
/// @file Optimises the pose graph of a file and says what came of it.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "common/formats/graph_file.hpp"
#include "common/graph/certificate.hpp"
#include "common/graph/robust.hpp"

namespace modslam {

struct OptimizeRequest {
  std::string method = "gauss-newton";  ///< or toro
  std::string init = "chordal";         ///< tree, odometry, file
  bool robust = false;                  ///< doubt the loops
  int sweeps = 100;                     ///< of TORO
};

struct OptimizeReport {
  double chi2_before = 0;  ///< of the poses in the file
  double chi2_start = 0;   ///< of the poses that the optimiser began with
  double chi2_after = 0;   ///< over the edges that are believed
  double chi2_all = 0;     ///< over all edges
  int iterations = 0;
  double cpu_ms = 0;  ///< of starting poses and optimisation
  double certificate_cpu_ms = 0;
  Certificate certificate;
  RobustResult robust;
};

/// Replaces the poses in `file`; its fixed vertex stays where it was.
OptimizeReport optimize_file(GraphFile& file, const OptimizeRequest& request);

std::string to_table(const GraphFile& file, const OptimizeRequest& request, const OptimizeReport& report);
nlohmann::ordered_json to_json(const GraphFile& file, const OptimizeRequest& request, const OptimizeReport& report);

/// The file without the edges that were refused.
GraphFile without_refused(const GraphFile& file, const OptimizeReport& report);

}  // namespace modslam
