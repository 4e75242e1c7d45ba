// SPDX-License-Identifier: BSD-3-Clause
/// procs/simulate — a drive through a simulated world → an LCM log, as fast as the machine.
/// Config: [simulator], [laser], [odometry], [ins].
#include <CLI/CLI.hpp>
#include <iomanip>
#include <iostream>

#include "common/bus/config.hpp"
#include "procs/simulate/simulate.hpp"

int main(int argc, char** argv) {
  std::string config = "config/modslam.toml", out;
  std::vector<std::string> overrides;
  CLI::App app("Drives the configured route through a simulated world and writes an LCM log");
  app.add_option("out", out, "the LCM log to write")->required();
  app.add_option("--config", config, "configuration file")->capture_default_str();
  app.add_option("--set", overrides, "table.key=value, over the file; repeatable")
      ->take_all()
      ->expected(1);
  CLI11_PARSE(app, argc, argv);
  try {
    const modslam::SimulatedRun run =
        modslam::simulate(modslam::load_config(config, overrides), out);
    std::cout << out << ": " << std::fixed << std::setprecision(1) << run.path_m << " m in "
              << run.duration_s << " s, " << run.scans << " scans, largest odometry error "
              << std::setprecision(2) << run.odometry_max_error_m << " m\n  " << run.words
              << std::endl;
    return run.arrived ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "modslam-simulate: " << error.what() << std::endl;
    return 1;
  }
}
