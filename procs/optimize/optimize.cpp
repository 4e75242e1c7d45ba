// SPDX-License-Identifier: BSD-3-Clause
#include "procs/optimize/optimize.hpp"

#include <algorithm>
#include <ctime>
#include <iomanip>
#include <sstream>

#include "common/graph/toro.hpp"

namespace modslam {
namespace {

/// CPU time of a piece of work.
template <class Work>
double cpu_ms(Work&& work) {
  const auto now_ms = [] {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
  };
  const double before = now_ms();
  work();
  return now_ms() - before;
}

void optimize_plainly(PoseGraph& graph, const OptimizeRequest& request, OptimizeReport& report) {
  const OptimizeOptions options{request.method == "toro" ? request.sweeps : 200, 1e-7, 0.0};
  SparseOptimizer optimizer(graph);
  if (request.init == "chordal") optimizer.initialize_chordal(graph);
  if (request.init == "tree") initialize_from_tree(graph);
  if (request.init == "odometry") initialize_from_odometry(graph);
  report.chi2_start = graph_chi2(graph);
  const OptimizeResult result = request.method == "toro" ? Toro().optimize(graph, options) : optimizer.optimize(graph, options);
  report.iterations = result.iterations;
}

bool is_refused(const OptimizeReport& report, std::size_t edge) {
  return std::binary_search(report.robust.refused.begin(), report.robust.refused.end(), edge);
}

/// The proof wants the minimum to more digits than anybody else.
void polish(PoseGraph& graph, const OptimizeRequest& request, const OptimizeReport& report) {
  if (request.method == "toro") return;
  EdgeWeights weights(graph.edges.size(), 1.0);
  for (const std::size_t k : report.robust.refused) weights[k] = 0;
  SparseOptimizer(graph).optimize(graph, {20, 1e-13, 0.0}, weights);
}

std::size_t loops_in(const PoseGraph& graph) {
  return static_cast<std::size_t>(
      std::count_if(graph.edges.begin(), graph.edges.end(), [](const GraphEdge& edge) { return edge.kind == EdgeKind::kLoop; }));
}

}  // namespace

OptimizeReport optimize_file(GraphFile& file, const OptimizeRequest& request) {
  OptimizeReport report;
  PoseGraph& graph = file.graph;
  const Pose2 T_map_fixed = graph.poses[file.fixed];
  report.chi2_before = graph_chi2(graph);
  report.cpu_ms = cpu_ms([&] {
    if (!request.robust) return optimize_plainly(graph, request, report);
    report.robust = optimize_robustly(graph, RobustOptions());
    report.iterations = report.robust.rounds;
  });
  report.certificate_cpu_ms = cpu_ms([&] { polish(graph, request, report); });
  const Pose2 T_map_graph = T_map_fixed * graph.poses[file.fixed].inverse();
  for (Pose2& pose : graph.poses) pose = T_map_graph * pose;
  graph.poses[file.fixed] = T_map_fixed;
  const PoseGraph believed = without_refused(file, report).graph;
  report.chi2_after = graph_chi2(believed);
  report.chi2_all = graph_chi2(graph);
  report.certificate_cpu_ms += cpu_ms([&] { report.certificate = certify(believed); });
  return report;
}

GraphFile without_refused(const GraphFile& file, const OptimizeReport& report) {
  GraphFile out = file;
  out.graph.edges.clear();
  for (std::size_t k = 0; k < file.graph.edges.size(); ++k)
    if (!is_refused(report, k)) out.graph.edges.push_back(file.graph.edges[k]);
  return out;
}

std::string to_table(const GraphFile& file, const OptimizeRequest& request, const OptimizeReport& report) {
  std::ostringstream out;
  const auto row = [&](const char* name) -> std::ostream& { return out << "\n" << std::left << std::setw(22) << name; };
  out << std::setprecision(9);
  row("nodes") << file.ids.size();
  row("edges") << file.graph.edges.size() << ", " << loops_in(file.graph) << " of them loops";
  row("method") << (request.robust ? "gauss-newton, loops doubted" : request.method + " from " + request.init);
  row("chi2 of the file") << (file.has_vertices ? "" : "(no poses in it; from a tree) ") << report.chi2_before;
  if (!request.robust) row("chi2 of the start") << report.chi2_start;
  row("chi2 in the end") << report.chi2_after;
  if (request.robust) row("  with refused edges") << report.chi2_all;
  row(request.robust ? "optimisations" : "iterations") << report.iterations;
  row("CPU") << std::setprecision(3) << report.cpu_ms << " ms, certificate " << report.certificate_cpu_ms << " ms";
  row("certificate") << std::setprecision(9)
                     << (report.certificate.is_optimal ? "the global minimum: no poses have less than " : "none: proven is only that no poses have less than ")
                     << report.certificate.lower_bound << std::setprecision(3) << " (smallest eigenvalue " << report.certificate.min_eigenvalue
                     << ")";
  if (request.robust) row("refused loops") << report.robust.refused.size() << " (limit of chi2 " << report.robust.chi2_limit << ")";
  return out.str().substr(1) + "\n";
}

nlohmann::ordered_json to_json(const GraphFile& file, const OptimizeRequest& request, const OptimizeReport& report) {
  nlohmann::ordered_json json{{"nodes", file.ids.size()},
                              {"edges", file.graph.edges.size()},
                              {"loops", loops_in(file.graph)},
                              {"method", request.method},
                              {"init", request.robust ? "chordal" : request.init},
                              {"robust", request.robust},
                              {"chi2_before", report.chi2_before},
                              {"chi2_after", report.chi2_after},
                              {"chi2_all_edges", report.chi2_all},
                              {"iterations", report.iterations},
                              {"cpu_ms", report.cpu_ms},
                              {"certificate",
                               {{"is_optimal", report.certificate.is_optimal},
                                {"lower_bound", report.certificate.lower_bound},
                                {"min_eigenvalue", report.certificate.min_eigenvalue},
                                {"cpu_ms", report.certificate_cpu_ms}}}};
  if (!request.robust) return json;
  json["chi2_limit"] = report.robust.chi2_limit;
  json["supported_loops"] = report.robust.supported;
  json["refused"] = nlohmann::ordered_json::array();
  for (const std::size_t k : report.robust.refused) {
    const GraphEdge& edge = file.graph.edges[k];
    json["refused"].push_back({{"edge", k},  // counts the edges of the file from 0
                               {"from", file.ids[static_cast<std::size_t>(edge.from)]},
                               {"to", file.ids[static_cast<std::size_t>(edge.to)]},
                               {"chi2", edge_chi2(edge, file.graph.poses)}});
  }
  return json;
}

}  // namespace modslam
