// SPDX-License-Identifier: BSD-3-Clause
/// modslam-report: run.lcm -> the map, the path, the graph, the semantic map, summary.json and
/// report.html of a run. Exit code 0: all is well; 1: nothing could be read or written; 2: written,
/// but the log is damaged.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "common/formats/atomic_file.hpp"
#include "procs/report/compare.hpp"
#include "procs/report/report.hpp"

namespace {

/// A wild array length in a damaged log must end in bad_alloc, not in the machine's memory.
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit limit{rlim_t{8} << 30, rlim_t{8} << 30};
  setrlimit(RLIMIT_DATA, &limit);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  modslam::report::ReportOptions options;
  bool table = false, world_of = false;
  std::vector<std::string> compared;
  std::string out = "comparison.html";
  CLI::App app("Makes the files of a run's folder from its LCM log, or compares runs.");
  CLI::Option* const folder = app.add_option("DIR", options.folder, "folder of the run; the results are written there");
  app.add_option("--compare", compared, "folders of runs: write a page that compares them")->excludes(folder);
  app.add_option("--out", out, "of --compare")->capture_default_str();
  app.add_option("--log", options.log, "the LCM log [DIR/run.lcm]");
  app.add_option("--world-truth", options.world_truth,
                 "GeoJSON of the simulated world, drawn under what was found");
  app.add_flag("--world-of", world_of, "only print the name of the simulated world, if the log names one");
  app.add_flag("--table", table, "only print the table of a run that has its summary.json");
  CLI11_PARSE(app, argc, argv);
  limit_memory();
  try {
    if (!compared.empty()) {
      modslam::write_atomically(out, modslam::report::comparison_page(compared));
      return 0;
    }
    if (options.folder.empty()) throw std::runtime_error("which folder? See --help");
    if (world_of) {
      std::cout << modslam::report::world_of(options);
      return 0;
    }
    if (table) {
      std::cout << modslam::report::table_of(options.folder);
      return 0;
    }
    const std::string trouble = modslam::report::write_report(options);
    if (trouble.empty()) return 0;
    std::cerr << "modslam-report: the log is damaged: " << trouble
              << "\nThe results hold all that could be read.\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "modslam-report: " << error.what() << std::endl;
    return 1;
  }
}
