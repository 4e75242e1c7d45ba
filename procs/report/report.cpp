// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/report.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "common/bus/channels.hpp"
#include "common/bus/log.hpp"
#include "common/evaluation/path.hpp"
#include "common/formats/atomic_file.hpp"
#include "common/formats/map_server.hpp"
#include "common/formats/tum_writer.hpp"
#include "common/semantics/semantic_files.hpp"
#include "common/topology/topology.hpp"
#include "procs/report/figures.hpp"
#include "procs/report/page.hpp"
#include "procs/report/world_scores.hpp"

namespace modslam::report {
namespace {

std::string dump(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// All that stands in the way of believing the log whole.
std::string troubles(const RunRecord& run, const Results& results) {
  std::string words = run.damage;
  const auto add = [&](const std::string& more) { words += (words.empty() ? "" : "; ") + more; };
  for (const auto& [name, tally] : run.channels)
    if (tally.undecodable)
      add(std::to_string(tally.undecodable) + " messages on " + name + " cannot be decoded");
  if (!results.map_trouble.empty()) add("no map: " + results.map_trouble);
  return words;
}

std::string log_of(const ReportOptions& options) {
  return options.log.empty() ? options.folder + "/run.lcm" : options.log;
}

/// Paths that other systems made of the same log (DIR/peers/NAME.tum), for the error plots.
std::map<std::string, std::vector<PathPose>> read_peers(const std::string& folder) {
  std::map<std::string, std::vector<PathPose>> peers;
  if (!std::filesystem::is_directory(folder)) return peers;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (file.path().extension() != ".tum") continue;
    std::ifstream in(file.path());
    std::stringstream text;
    text << in.rdbuf();
    try {
      for (const StampedPose& p : parse_tum(text.str()))
        peers[file.path().stem().string()].push_back({std::llround(1e6 * p.stamp_s), p.pose});
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(file.path().string() + ": " + error.what());
    }
  }
  return peers;
}

}  // namespace

std::string world_of(const ReportOptions& options) {
  LogReader reader(log_of(options));
  LogEvent event;
  while (reader.next(event)) {
    if (event.channel != channel::kSimInfo) continue;
    sim_info_t info{};
    const int size = static_cast<int>(event.bytes.size());
    if (info.decode(event.bytes.data(), 0, size) == size) return info.world;
  }
  return "";
}

std::string write_report(const ReportOptions& options) {
  std::optional<WorldOutline> world;
  if (!options.world_truth.empty()) world = read_world_outline(options.world_truth);
  const std::string log = log_of(options);
  RunRecord run = read_run(log);
  run.peers = read_peers(options.folder + "/peers");
  const Results results = work_out(run);
  Json summary = summarise(run, results);
  if (world) {
    const Json scores = score_world(options.world_truth, log, run, results);
    if (!scores.is_null()) summary["semantic_scores"] = scores;
  }

  const auto write = [&](const char* name, const std::string& bytes) {
    write_atomically(options.folder + "/" + name, bytes);
  };
  write("map.png", map_server_png(results.map));
  write("map.yaml", map_server_yaml(results.map, "map.png"));
  const SemanticLayers layers = layers_of(run.semantics, results.nodes);
  write("semantic.geojson", semantic_geojson(layers));
  std::vector<Eigen::Vector2d> path;
  for (const auto& [id, pose] : results.nodes) path.push_back(pose.translation());
  write("topology.json", topology_json(build_topology(layers, path)));
  write("path.tum", tum_text(results.path));
  write("path_laser.tum", tum_text(results.path_laser));
  write("graph.g2o", results.graph_g2o);
  write("report.html", report_page(run, results, summary, world ? &*world : nullptr));
  std::filesystem::create_directories(options.folder + "/figures");
  for (const auto& [name, svg] : figures_of(run, results))
    write(("figures/" + name + ".svg").c_str(), svg);
  write("summary.json", dump(summary));
  return troubles(run, results);
}

std::string table_of(const std::string& folder) {
  const std::string path = folder + "/summary.json";
  std::ifstream in(path);
  if (!in)
    throw std::runtime_error(path + ": cannot be opened; run modslam-report " + folder + " first");
  try {
    return terminal_table(Json::parse(in), folder);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(path + ": is no summary of a run: " + error.what());
  }
}

}  // namespace modslam::report
