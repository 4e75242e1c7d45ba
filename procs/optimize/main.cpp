// SPDX-License-Identifier: BSD-3-Clause
/// procs/optimize — a pose graph in a g2o or TORO file to the optimum, with a proof where there is one.
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/formats/atomic_file.hpp"
#include "common/formats/file_bytes.hpp"
#include "procs/optimize/optimize.hpp"

namespace {

using namespace modslam;

GraphFile read(const std::string& path) {
  const FileBytes file = read_file_bytes(path);
  if (!file.damage.empty()) throw std::runtime_error(path + ": " + file.damage);
  try {
    return parse_graph(file.bytes);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

GraphFormat format_of(const std::string& path) {
  const auto dot = path.rfind('.');
  const std::string ending = dot == path.npos ? "" : path.substr(dot);
  return ending == ".graph" || ending == ".toro" ? GraphFormat::kToro : GraphFormat::kG2o;
}

}  // namespace

int main(int argc, char** argv) {
  OptimizeRequest request;
  std::string in, out, json;
  CLI::App app("Optimises a planar pose graph: g2o (VERTEX_SE2, EDGE_SE2, FIX) or TORO (VERTEX2, EDGE2), also .gz and .xz.");
  app.add_option("file", in, "the graph")->required();
  app.add_option("--method", request.method, "gauss-newton (sparse, to the minimum) or toro (stochastic descent)")
      ->check(CLI::IsMember({"gauss-newton", "toro"}));
  auto* init = app.add_option("--init", request.init, "poses to begin with: chordal (default), tree, odometry, file")
                   ->check(CLI::IsMember({"chordal", "tree", "odometry", "file"}));
  app.add_option("--sweeps", request.sweeps, "of toro, at most")->check(CLI::Range(1, 1'000'000));
  auto* robust = app.add_flag("--robust", request.robust, "doubt every edge that is not from a node to the next");
  app.add_option("--out", out, "writes the graph without refused edges here; .graph or .toro: as TORO has it, else g2o");
  app.add_option("--json", json, "writes the figures, and which edges were refused, here");
  robust->excludes(init);
  CLI11_PARSE(app, argc, argv);
  try {
    if (request.robust && request.method == "toro") throw std::runtime_error("--robust needs --method gauss-newton");
    GraphFile file = read(in);
    const OptimizeReport report = optimize_file(file, request);
    std::cout << to_table(file, request, report);
    if (!out.empty()) write_atomically(out, graph_text(without_refused(file, report), format_of(out)));
    if (!json.empty()) write_atomically(json, to_json(file, request, report).dump(1) + "\n");
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "modslam-optimize: " << error.what() << std::endl;
    return 1;
  }
}
