// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/config.hpp"

#include <catch2/catch.hpp>
#include <cstdio>
#include <fstream>

#include "tests/support/temporary_folder.hpp"

using namespace modslam;
using Catch::Matchers::Contains;
using test::TemporaryFolder;

namespace {

struct ConfigFile {
  explicit ConfigFile(const std::string& text) { std::ofstream(path) << text; }
  TemporaryFolder folder;
  std::string path = folder.path + "/a.toml";
};

/// What load_config says about a file; "" when it is content.
std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const ConfigFile file(text);
  try {
    load_config(file.path, overrides);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("the shipped file is the default configuration with its comments") {
  std::ifstream in(MODSLAM_SOURCE_DIR "/config/modslam.toml");
  const std::string shipped((std::istreambuf_iterator<char>(in)), {});
  REQUIRE(shipped.find(to_toml(SystemConfig(), true)) != std::string::npos);
}

TEST_CASE("a value in the file counts, the others keep their defaults, --set has the last word") {
  const ConfigFile file("[graph_optimizer]\nnode_m = 0.7\nmethod = \"toro\"\nconfirmations = 5\n");
  const SystemConfig config = load_config(file.path, {"graph_optimizer.node_m=0.9", "launch.estimator=odometry", "launch.viewer=false"});
  REQUIRE(config.graph_optimizer.node_m == 0.9);
  REQUIRE(config.graph_optimizer.method == "toro");
  REQUIRE(config.graph_optimizer.confirmations == 5);
  REQUIRE(config.graph_optimizer.node_rad == EstimatorConfig().node_rad);
  REQUIRE(config.launch.estimator == "odometry");
  REQUIRE_FALSE(config.launch.viewer);
}

TEST_CASE("what is wrong in a file is named with its line, key, value and bound") {
  REQUIRE_THAT(complaint("[scan_matcher]\n\nwindov_m = 1\n"), Contains("a.toml:3: scan_matcher.windov_m is not a known key"));
  REQUIRE_THAT(complaint("[launch]\n[scanmatcher]\n"), Contains("a.toml:2: scanmatcher is not a known table"));
  REQUIRE_THAT(complaint("[scan_matcher]\nwindow_m = \"wide\"\n"), Contains("a.toml:2: scan_matcher.window_m must be a number"));
  REQUIRE_THAT(complaint("[scan_matcher]\nwindow_m = 17.5\n"), Contains("a.toml:2: scan_matcher.window_m = 17.5 is outside [0.02, 2.0] m"));
  REQUIRE_THAT(complaint("[scan_matcher]\nwindow_m = nan\n"), Contains("is outside"));
  REQUIRE_THAT(complaint("[scan_matcher]\nkeyframes = 1.5\n"), Contains("a.toml:2: scan_matcher.keyframes must be a whole number"));
  REQUIRE_THAT(complaint("[scan_matcher]\nkeyframes = 0\n"), Contains("= 0 is outside [1, 500]"));
  REQUIRE_THAT(complaint("[launch]\nviewer = 1\n"), Contains("a.toml:2: launch.viewer must be true or false"));
  REQUIRE_THAT(complaint("[launch]\nestimator = \"magic\"\n"), Contains("is not one of graph_optimizer | "));
  REQUIRE_THAT(complaint("[launch]\nestimator = 3\n"), Contains("must be a text in quotes"));
  REQUIRE_THAT(complaint("launch = 3\n"), Contains("a.toml:1: launch must be a table"));
  REQUIRE_THAT(complaint("[launch]\nviewer = = true\n"), Contains("a.toml:2: "));
}

TEST_CASE("what is wrong on the command line is named with its text") {
  REQUIRE_THAT(complaint("", {"nonsense"}), Contains("--set nonsense: expected table.key=value"));
  REQUIRE_THAT(complaint("", {"scan_matcher.window_m=40"}), Contains("--set scan_matcher.window_m=40") && Contains("is outside"));
  REQUIRE_THAT(complaint("", {"nowhere.key=1"}), Contains("nowhere is not a known table"));
}

TEST_CASE("a missing file is named") {
  REQUIRE_THROWS_WITH(load_config("/nowhere/at/all.toml"), Contains("/nowhere/at/all.toml: there is no such file"));
}

TEST_CASE("a printed configuration reads back as itself, and single values can be asked for") {
  SystemConfig config;
  config.scan_matcher.window_m = 0.123456789012;
  config.simulator.world = "a \"quoted\" name";
  const ConfigFile file(to_toml(config, true));
  REQUIRE(to_toml(load_config(file.path), false) == to_toml(config, false));
  REQUIRE(config_value(config, "simulator.world") == "a \"quoted\" name");
  REQUIRE(config_value(config, "launch.viewer") == "true");
  REQUIRE_THROWS_AS(config_value(config, "launch.nothing"), ConfigError);
}

TEST_CASE("what trips the TOML parser itself is refused in words: a cut line, and letters beyond ASCII where none belong") {
  for (const std::string name : {"assertion", "foreign_letter"}) {
    const std::string path = std::string(MODSLAM_SOURCE_DIR) + "/tests/fuzz/seeds/config/" + name + ".toml";
    REQUIRE_THROWS_AS(load_config(path), ConfigError);
  }
  const ConfigFile good("# schön\n[recorder]\npath = 'länge # \"nicht\" hier'  # ä\n");
  REQUIRE(load_config(good.path).recorder.path == "länge # \"nicht\" hier");
}
