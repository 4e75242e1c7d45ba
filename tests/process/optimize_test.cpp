// SPDX-License-Identifier: BSD-3-Clause
#include "procs/optimize/optimize.hpp"

#include "tests/support/false_loops.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A field whose ids are 100, 110, ...; vertex 3 is fixed at a place of its own.
GraphFile field_file(std::vector<Pose2>* truth = nullptr) {
  GraphFile file;
  file.graph = swept_field(10, 0.03, 601, truth);
  for (std::size_t k = 0; k < file.graph.poses.size(); ++k) file.ids.push_back(static_cast<std::int64_t>(100 + 10 * k));
  for (Pose2& pose : file.graph.poses) pose = Pose2(7, -2, 1) * pose;
  file.fixed = 3;
  file.has_vertices = true;
  return file;
}

}  // namespace

TEST_CASE("optimize leaves the fixed vertex where it was and reports the minimum with its proof") {
  for (const char* init : {"chordal", "tree", "odometry", "file"}) {
    GraphFile file = field_file();
    const Pose2 fixed = file.graph.poses[3];
    OptimizeRequest request;
    request.init = init;
    const OptimizeReport report = optimize_file(file, request);
    INFO(init);
    REQUIRE_THAT(file.graph.poses[3], IsNear(fixed, 0, 0));
    REQUIRE(report.chi2_after < report.chi2_before);
    REQUIRE(report.chi2_after == Approx(graph_chi2(file.graph)).epsilon(1e-9));
    REQUIRE(report.certificate.is_optimal);
    const auto json = to_json(file, request, report);
    REQUIRE(json["nodes"] == 100);
    REQUIRE(json["certificate"]["is_optimal"] == true);
    REQUIRE_FALSE(json.contains("refused"));
    REQUIRE(to_table(file, request, report).find("the global minimum") != std::string::npos);
  }
}

TEST_CASE("optimize --robust names the refused edges by the file's ids and writes the others") {
  std::vector<Pose2> truth;
  GraphFile file = field_file(&truth);
  const std::size_t true_edges = file.graph.edges.size();
  add_false_loops(file.graph, truth, 40, FalseLoops::kAnywhere, 10, 602);
  OptimizeRequest request;
  request.robust = true;
  const OptimizeReport report = optimize_file(file, request);
  const auto json = to_json(file, request, report);
  REQUIRE(json["refused"].size() == 40);
  for (std::size_t k = 0; k < 40; ++k) {
    const GraphEdge& edge = file.graph.edges[true_edges + k];
    REQUIRE(json["refused"][k]["edge"] == true_edges + k);
    REQUIRE(json["refused"][k]["from"] == 100 + 10 * edge.from);
    REQUIRE(json["refused"][k]["to"] == 100 + 10 * edge.to);
  }
  const GraphFile kept = parse_graph(graph_text(without_refused(file, report), GraphFormat::kG2o));
  REQUIRE(kept.graph.edges.size() == true_edges);
  REQUIRE(kept.fixed == 3);
  REQUIRE(graph_chi2(kept.graph) == Approx(report.chi2_after).epsilon(1e-9));
}

TEST_CASE("TORO gets near the minimum of a field, and proofs stay honest") {
  GraphFile file = field_file(), exact = field_file();
  OptimizeRequest request;
  const double best = optimize_file(exact, request).chi2_after;
  request.method = "toro";
  request.init = "odometry";
  const OptimizeReport report = optimize_file(file, request);
  REQUIRE(report.chi2_after < report.chi2_start);
  REQUIRE(report.chi2_after < 2 * best);
  if (report.certificate.is_optimal) REQUIRE(report.chi2_after < best * (1 + 2e-6));
  REQUIRE(report.certificate.lower_bound <= best * (1 + 1e-9));
}
