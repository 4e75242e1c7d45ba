// SPDX-License-Identifier: BSD-3-Clause
/// modslam-config: checks a configuration file, or prints the defaults as one. config/modslam.toml is made by `--defaults`.
#include <CLI/CLI.hpp>
#include <iostream>

#include "common/bus/config.hpp"

int main(int argc, char** argv) {
  std::string file = "config/modslam.toml", value_of;
  std::vector<std::string> overrides;
  bool defaults = false;
  CLI::App app("Checks a configuration file and prints what is in force");
  app.add_option("--config", file, "configuration file")->capture_default_str();
  app.add_option("--set", overrides, "table.key=value, over the file; repeatable");
  app.add_flag("--defaults", defaults, "print the defaults with unit, range and effect of every key");
  app.add_option("--get", value_of, "print one value: table.key");
  CLI11_PARSE(app, argc, argv);
  try {
    if (defaults) {
      std::cout << modslam::to_toml(modslam::SystemConfig{}, true);
      return 0;
    }
    const modslam::SystemConfig config = modslam::load_config(file, overrides);
    if (value_of.empty())
      std::cout << modslam::to_toml(config, false);
    else
      std::cout << modslam::config_value(config, value_of) << std::endl;
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "config: " << error.what() << std::endl;
    return 1;
  }
}
