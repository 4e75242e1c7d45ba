// SPDX-License-Identifier: BSD-3-Clause
/// procs/evaluate — scores a path against relations or a true path, and a semantic map against the
/// true world.
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "common/bus/run_log.hpp"
#include "common/evaluation/score_json.hpp"
#include "common/formats/file_bytes.hpp"
#include "common/formats/text_fields.hpp"

namespace {

using namespace modslam;

struct Arguments {
  std::string relations, times, path, truth, semantic, world_truth, log, align, json;
  bool exact = false;
};

/// Parses a file's text; what is wrong with it is said with its name.
template <class Parse>
auto parsed(const std::string& path, Parse&& parse) {
  const FileBytes file = read_file_bytes(path);
  if (!file.damage.empty()) throw std::runtime_error(path + ": " + file.damage);
  try {
    return parse(file.bytes);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

RunLog run_log(const std::string& path) {
  RunLog log = read_run_log(path);
  if (!log.damage.empty()) std::cerr << path << ": " << log.damage << "\n";
  if (log.bad_messages) std::cerr << path << ": " << log.bad_messages << " messages refused\n";
  if (log.truth.empty()) throw std::runtime_error(path + ": holds no GROUND_TRUTH");
  return log;
}

void evaluate_relations(const Arguments& arguments, nlohmann::ordered_json& json) {
  const auto relations = parsed(arguments.relations, parse_relations);
  const auto times = parsed(arguments.times, ScanTimes::parse);
  const auto path = parsed(arguments.path, parse_tum);
  const RelationScores scores = score_relations(relations, times, index_path(path, times));
  std::cout << to_table(scores, arguments.exact);
  json["relations"] = to_json(scores);
}

void evaluate_path(const Arguments& arguments, nlohmann::ordered_json& json) {
  const TruthScores scores =
      score_against_truth(parsed(arguments.path, parse_tum), run_log(arguments.truth).truth);
  std::cout << to_table(scores);
  json["truth"] = to_json(scores);
}

/// Where the map lies in the world: as told, or by the first pose that has a truth. The last resort
/// is the definition of the map frame, the robot at its first sweep.
Pose2 find_alignment(const Arguments& arguments, const RunLog& log) {
  if (!arguments.align.empty()) {
    TextFields fields(arguments.align, ", ");
    const Pose2 T_world_map = fields.pose("--align");
    fields.expect_left(0);
    return T_world_map;
  }
  if (log.truth.empty()) return {};
  Path path = arguments.path.empty() ? log.estimate : parsed(arguments.path, parse_tum);
  if (path.empty() && !log.scans.empty())
    path = {{static_cast<double>(log.scans.front().scan.utime) * 1e-6, {}}};
  const std::vector<PosePair> pairs = pair_with_truth(path, log.truth);
  if (pairs.empty())
    throw std::runtime_error(
        "no pose of the path has a true pose at its time: use --align x,y,heading");
  return align_first(pairs);
}

void evaluate_semantics(const Arguments& arguments, nlohmann::ordered_json& json) {
  const SemanticMap truth = parsed(arguments.world_truth, parse_semantic_map);
  const RunLog log = arguments.log.empty() ? RunLog() : run_log(arguments.log);
  const Pose2 T_world_map = find_alignment(arguments, log);
  const SemanticMap found =
      transformed(T_world_map, parsed(arguments.semantic, parse_semantic_map));
  if (!arguments.log.empty() && log.scans.empty())
    throw std::runtime_error(
        arguments.log +
        ": holds no LASER sweep with a SENSOR_INFO before and GROUND_TRUTH around it");
  const Visibility visibility =
      arguments.log.empty() ? everything_visible(truth) : visible_in(truth, log.scans);
  const SemanticScores scores = score_semantics(found, truth, visibility);
  std::cout << to_table(scores);
  json["semantics"] = to_json(scores);
  json["semantics"]["T_world_map"] = {T_world_map.x, T_world_map.y, T_world_map.heading};
}

void evaluate(const Arguments& arguments) {
  nlohmann::ordered_json json;
  if (!arguments.relations.empty()) evaluate_relations(arguments, json);
  if (!arguments.truth.empty()) evaluate_path(arguments, json);
  if (!arguments.semantic.empty()) evaluate_semantics(arguments, json);
  if (json.empty())
    throw std::runtime_error("nothing to score: give --relations, --truth or --semantic");
  if (arguments.json.empty()) return;
  std::ofstream out(arguments.json);
  out << json.dump(1) << "\n";
  if (!out.flush()) throw std::runtime_error(arguments.json + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Scores what a run produced. Files may be .gz or .xz.");
  auto* relations = app.add_option("--relations", arguments.relations,
                                   "true motions of the laser: t1 t2 x y z roll pitch yaw");
  auto* times =
      app.add_option("--times", arguments.times, "CSV scan_index,ipc_timestamp,exact of the log");
  auto* path = app.add_option(
      "--path", arguments.path,
      "the estimated path (TUM): of the laser with --relations, of the robot otherwise");
  app.add_flag("--exact", arguments.exact, "print only relations whose stamps are both exact");
  auto* truth = app.add_option("--truth", arguments.truth, "LCM log with GROUND_TRUTH");
  auto* semantic = app.add_option("--semantic", arguments.semantic,
                                  "the semantic map that was found (GeoJSON, map frame)");
  auto* world =
      app.add_option("--world-truth", arguments.world_truth, "the true one (GeoJSON, world frame)");
  app.add_option("--log", arguments.log, "LCM log of the run: what it never saw does not count");
  app.add_option("--align", arguments.align,
                 "T_world_map as x,y,heading [m, m, rad]; default: by the first pose");
  app.add_option("--json", arguments.json, "also write the scores here");
  relations->needs(times)->needs(path);
  truth->needs(path);
  relations->excludes(truth);  // their paths are of different frames
  semantic->needs(world);
  CLI11_PARSE(app, argc, argv);
  try {
    evaluate(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "modslam-evaluate: " << error.what() << std::endl;
    return 1;
  }
}
