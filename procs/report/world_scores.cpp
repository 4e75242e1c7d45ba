// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/world_scores.hpp"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "common/bus/run_log.hpp"
#include "common/evaluation/score_json.hpp"
#include "common/semantics/semantic_files.hpp"

namespace modslam::report {
namespace {

SemanticMap read_world(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path + ": cannot be opened");
  try {
    return parse_semantic_map({std::istreambuf_iterator<char>(in), {}});
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace

Json score_world(const std::string& world_path, const std::string& log_path, const RunRecord& run,
                 const Results& results) {
  const SemanticMap world = read_world(world_path);
  if (!results.error) return nullptr;
  const SemanticMap found = transformed(results.error->first.T_world_map,
                                        parse_semantic_map(semantic_geojson(layers_of(run.semantics, {}))));
  return to_json(score_semantics(found, world, visible_in(world, read_run_log(log_path).scans)));
}

}  // namespace modslam::report
