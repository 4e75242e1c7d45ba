// SPDX-License-Identifier: BSD-3-Clause
/// graph-bench FOLDER --json FILE --markdown FILE: every planar graph of a folder, ours and yardsticks in one run.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "common/formats/atomic_file.hpp"
#include "common/formats/file_bytes.hpp"
#include "common/formats/graph_file.hpp"
#include "common/graph/certificate.hpp"
#include "common/graph/robust.hpp"
#include "common/graph/toro.hpp"
#include "tests/bench/yardsticks.hpp"
#include "tests/support/false_loops.hpp"

namespace {

using namespace modslam;
using namespace modslam::bench;
using Json = nlohmann::ordered_json;

constexpr int kRepetitions = 7;
// Least chi2 that we know of, by the start of a file's name.
const std::map<std::string, double> kBestKnown = {{"input_INTEL", 215.8404}, {"g2o_intel", 546.4611},    {"g2o_manhattanOlson3500", 146.0766},
                                                  {"ring.", 11.1631},        {"sesync_CSAIL", 40.5551}};

struct Outcome {
  double chi2 = 0, ms = 0;
  int iterations = 0;
};

/// Median CPU time of `repetitions`; `run` returns its seconds.
Outcome measured(const PoseGraph& start, int repetitions, const std::function<double(PoseGraph&, int&)>& run) {
  Outcome outcome;
  std::vector<double> ms;
  for (int k = 0; k < repetitions; ++k) {
    PoseGraph graph = start;
    ms.push_back(1e3 * run(graph, outcome.iterations));
    outcome.chi2 = graph_chi2(graph);
  }
  std::sort(ms.begin(), ms.end());
  outcome.ms = ms[ms.size() / 2];
  return outcome;
}

Outcome timed(const PoseGraph& start, int repetitions, const std::function<int(PoseGraph&)>& work) {
  return measured(start, repetitions, [&](PoseGraph& graph, int& iterations) {
    const double before = cpu_seconds();
    iterations = work(graph);
    return cpu_seconds() - before;
  });
}

Outcome ours(const PoseGraph& start) {
  return timed(start, kRepetitions, [](PoseGraph& graph) {
    SparseOptimizer optimizer(graph);
    optimizer.initialize_chordal(graph);
    return optimizer.optimize(graph, {100, 1e-6, 0.0}).iterations;
  });
}

Outcome ceres(const PoseGraph& start) {
  return measured(start, kRepetitions, [](PoseGraph& graph, int& iterations) {
    double seconds = 0;
    iterations = optimize_ceres(graph, seconds).iterations;
    return seconds;
  });
}

Outcome toro(const PoseGraph& start, int sweeps, int repetitions) {
  return timed(start, repetitions, [&](PoseGraph& graph) { return Toro().optimize(graph, {sweeps, 0.0, 0.0}).iterations; });
}

Json to_json(const Outcome& outcome) { return {{"chi2", outcome.chi2}, {"ms", outcome.ms}, {"iterations", outcome.iterations}}; }

Json bench_file(const std::string& name, const PoseGraph& file) {
  PoseGraph odometry = file, tree = file, best = file;
  initialize_from_odometry(odometry);
  initialize_from_tree(tree);
  SparseOptimizer optimizer(best);
  optimizer.initialize_chordal(best);
  optimizer.optimize(best, {100, 1e-12, 0.0});
  Json row{{"file", name}, {"nodes", file.poses.size()}, {"edges", file.edges.size()}};
  for (const auto& [start, chi2] : kBestKnown)
    if (name.rfind(start, 0) == 0) row["best_known"] = chi2;
  row["ours"] = to_json(ours(file));
  row["ceres_odometry"] = to_json(ceres(odometry));
  row["ceres_tree"] = to_json(ceres(tree));
  row["gauss_newton_odometry"] =
      to_json(timed(odometry, 5, [](PoseGraph& graph) { return optimize_plain_gauss_newton(graph, 50).iterations; }));
  row["toro_100"] = to_json(toro(tree, 100, 1));
  row["toro_1000"] = to_json(toro(tree, 1000, 1));
  const Certificate certificate = certify(best);
  row["certificate"] = {{"is_optimal", certificate.is_optimal}, {"lower_bound", certificate.lower_bound}, {"min_eigenvalue", certificate.min_eigenvalue}};
  // Ceres counts where it reached the minimum; where it never did, with its better time all the same.
  const double reached = row["ours"]["chi2"].get<double>() * (1 + 1e-4);
  double reaching = 1e300, any = 1e300;
  for (const char* start : {"ceres_odometry", "ceres_tree"}) {
    const double ms = row[start]["ms"].get<double>();
    any = std::min(any, ms);
    if (row[start]["chi2"].get<double>() <= reached) reaching = std::min(reaching, ms);
  }
  row["times_faster_than_ceres"] = (reaching < 1e300 ? reaching : any) / row["ours"]["ms"].get<double>();
  return row;
}

/// False loops of both kinds: as many as the graph has four times over (80 % of all), and 1000.
Json bench_robust(const std::string& name, const PoseGraph& file) {
  PoseGraph clean = file;
  SparseOptimizer optimizer(clean);
  optimizer.initialize_chordal(clean);
  const double chi2_clean = optimizer.optimize(clean, {100, 1e-12, 0.0}).chi2_after;
  const auto loops = std::count_if(file.edges.begin(), file.edges.end(), [](const GraphEdge& e) { return e.kind == EdgeKind::kLoop; });
  Json rows = Json::array();
  for (const int count : {1000, static_cast<int>(4 * loops)})
    for (const auto kind : {test::FalseLoops::kSamePlace, test::FalseLoops::kAnywhere}) {
      PoseGraph graph = file;
      test::add_false_loops(graph, clean.poses, count, kind, 30, 1);
      std::vector<double> ms;
      RobustResult result;
      PoseGraph out;
      for (int k = 0; k < 5; ++k) {
        out = graph;
        const double before = cpu_seconds();
        result = optimize_robustly(out, {});
        ms.push_back(1e3 * (cpu_seconds() - before));
      }
      std::sort(ms.begin(), ms.end());
      const auto true_refused = std::count_if(result.refused.begin(), result.refused.end(), [&](std::size_t k) { return k < file.edges.size(); });
      PoseGraph true_edges = file;
      true_edges.poses = out.poses;
      rows.push_back({{"file", name},
                      {"false_loops", count},
                      {"kind", kind == test::FalseLoops::kSamePlace ? "same place" : "anywhere"},
                      {"true_loops", loops},
                      {"false_refused", static_cast<int>(result.refused.size()) - true_refused},
                      {"true_refused", true_refused},
                      {"chi2_of_true_edges", graph_chi2(true_edges)},
                      {"chi2_clean", chi2_clean},
                      {"ms", ms[2]}});
    }
  return rows;
}

std::string number(double value, const char* format = "%.6g") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string cell(const Json& outcome) {
  return number(outcome["chi2"], "%.7g") + ", " + std::to_string(outcome["iterations"].get<int>()) + " it, " + number(outcome["ms"], "%.3g") + " ms";
}

std::string to_markdown(const Json& json) {
  std::string text =
      "| graph (nodes/edges) | best known | **ours** | proven optimal | Ceres from odometry | Ceres from tree | times faster than Ceres | plain "
      "Gauss-Newton from odometry | TORO 100 | TORO 1000 |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& row : json["graphs"])
    text += "| " + row["file"].get<std::string>() + " (" + row["nodes"].dump() + "/" + row["edges"].dump() + ") | " +
            (row.contains("best_known") ? number(row["best_known"], "%.7g") : "?") + " | **" + cell(row["ours"]) + "** | " +
            (row["certificate"]["is_optimal"] ? "yes" : "no") + " | " + cell(row["ceres_odometry"]) + " | " + cell(row["ceres_tree"]) + " | " +
            number(row["times_faster_than_ceres"], "%.1f") + " | " + cell(row["gauss_newton_odometry"]) + " | " + cell(row["toro_100"]) + " | " +
            cell(row["toro_1000"]) + " |\n";
  text += "\n| graph, true loops | false loops added | false refused | true refused | chi2 over the true edges, clean | ms |\n|---|---|---|---|---|---|\n";
  for (const Json& row : json["robust"])
    text += "| " + row["file"].get<std::string>() + ", " + row["true_loops"].dump() + " | " + row["false_loops"].dump() + ", " +
            row["kind"].get<std::string>() + " | " + row["false_refused"].dump() + " | " + row["true_refused"].dump() + " | " +
            number(row["chi2_of_true_edges"], "%.7g") + ", " + number(row["chi2_clean"], "%.7g") + " | " + number(row["ms"], "%.3g") + " |\n";
  return text;
}

Json bench_folder(const std::string& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().filename().string().find(".g2o") != std::string::npos && entry.path().filename().string().find("groundtruth") == std::string::npos)
      paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  Json json{{"graphs", Json::array()}, {"robust", Json::array()}};
  for (const auto& path : paths) {
    const std::string name = path.filename().string();
    try {
      const PoseGraph graph = parse_graph(read_file_bytes(path.string()).bytes).graph;
      std::cerr << name << " ..." << std::endl;
      json["graphs"].push_back(bench_file(name, graph));
      for (const Json& row : bench_robust(name, graph)) json["robust"].push_back(row);
    } catch (const std::runtime_error& error) {
      std::cerr << name << " is left out: " << error.what() << std::endl;
    }
  }
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  std::string folder, json_path, markdown_path;
  CLI::App app("Times every planar pose graph of a folder, ours beside Ceres, plain Gauss-Newton and TORO.");
  app.add_option("folder", folder)->required()->check(CLI::ExistingDirectory);
  app.add_option("--json", json_path);
  app.add_option("--markdown", markdown_path);
  CLI11_PARSE(app, argc, argv);
  try {
    const Json json = bench_folder(folder);
    const std::string markdown = to_markdown(json);
    std::cout << markdown;
    if (!json_path.empty()) write_atomically(json_path, json.dump(1) + "\n");
    if (!markdown_path.empty()) write_atomically(markdown_path, markdown);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "graph-bench: " << error.what() << std::endl;
    return 1;
  }
}
