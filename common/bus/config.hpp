// SPDX-License-Identifier: BSD-3-Clause
/// @file The one configuration file: every table of every module, checked as a whole.
#pragma once
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/system_config.hpp"

namespace modslam {

/// Text names file, line, key, value and bound.
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads `path`, then applies `overrides` ("table.key=value", TOML values; bare words are strings).
/// @throws ConfigError on a missing file, bad syntax, unknown table or key, wrong type, out of range.
SystemConfig load_config(const std::string& path, const std::vector<std::string>& overrides = {});

/// The whole configuration as a TOML file; with `comments`, each key under its unit, range and effect:
/// that is how config/modslam.toml is made.
std::string to_toml(SystemConfig config, bool comments);

/// One value as text, strings without quotes. @throws ConfigError when there is no such table.key.
std::string config_value(const SystemConfig& config, const std::string& table_dot_key);

}  // namespace modslam
