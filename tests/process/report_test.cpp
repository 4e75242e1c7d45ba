// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/report.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "procs/report/compare.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_building.hpp"
#include "tests/support/synthetic_run.hpp"

using namespace modslam;
namespace fs = std::filesystem;

namespace {

/// A folder that goes away with the test.
struct Folder {
  Folder() {
    std::string name = fs::temp_directory_path() / "modslam-report-XXXXXX";
    path = mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path); }
  std::string file(const std::string& name) const { return path + "/" + name; }
  std::string path;
};

std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::vector<double>> read_tum(const std::string& path) {
  std::vector<std::vector<double>> lines;
  std::istringstream in(read(path));
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    lines.emplace_back();
    for (double value; words >> value;) lines.back().push_back(value);
  }
  return lines;
}

const char* const kResults[] = {"map.png",        "map.yaml",  "semantic.geojson", "path.tum",
                                "path_laser.tum", "graph.g2o", "summary.json",     "report.html"};

int count_of(const std::string& text, const std::string& word) {
  int n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

}  // namespace

constexpr int kLostButNodes = 10;  // scans whose POSE is not in the log, but which became nodes: the graph knows them

TEST_CASE("the report turns a run's log into every file of its folder") {
  const Folder folder;
  const test::SyntheticRun run = test::write_synthetic_run(folder.file("run.lcm"), 900, 7);
  REQUIRE(report::write_report({folder.path, "", ""}) == "");
  for (const char* name : kResults) REQUIRE(fs::file_size(folder.file(name)) > 0);

  SECTION("each scan has a line in path_laser.tum, in file order, where the laser truly was") {
    const auto lines = read_tum(folder.file("path_laser.tum"));
    REQUIRE(lines.size() == run.truth.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      REQUIRE(lines[i].size() == 8);
      REQUIRE(lines[i][0] == Approx(static_cast<double>(run.truth[i].utime) * 1e-6).epsilon(1e-12));
      const Pose2 T_map_laser(lines[i][1], lines[i][2], 2 * std::atan2(lines[i][6], lines[i][7]));
      // Dead reckoning is 1 % wrong between nodes, which is spread; scans without a pose lie on the
      // chord.
      REQUIRE_THAT(
          T_map_laser,
          IsNear(between(run.T_world_map, run.truth[i].pose) * run.T_base_laser, 0.002, 0.003));
    }
    REQUIRE(read_tum(folder.file("path.tum")).size() == 900 - 900 / 7 + kLostButNodes);
  }
  SECTION("summary.json counts what happened") {
    const auto s = nlohmann::json::parse(read(folder.file("summary.json")));
    REQUIRE(s["scans"] == 900);
    REQUIRE(s["scans_without_pose"] == 900 / 7 - kLostButNodes);
    REQUIRE(s["graph"]["nodes"] == run.nodes);
    REQUIRE(s["graph"]["edges"] == run.nodes - 1 + run.loop_edges);
    REQUIRE(s["loops"]["accepted"] == run.loop_edges);
    REQUIRE(run.loop_edges > 0);
    REQUIRE(s["loops"]["worst_in_map"]["chi2"] >= 0);
    REQUIRE(s["loops"]["worst_in_truth"]["where_known_m"] < 0.1);
    REQUIRE(s["semantics"]["walls"] == 9);
    REQUIRE(s["semantics"]["rooms"] == 3);
    REQUIRE(s["error"]["aligned_at_first_pose"]["position_m"]["max"] < 0.002);
    REQUIRE(s["odometry_error"]["aligned_at_first_pose"]["position_m"]["max"] > 0.3);
    REQUIRE(s["processes"]["scan_matcher"]["bad"] == 2);
    REQUIRE(s["duration_s"] == Approx(89.9));
  }
  SECTION("the map shows the building where map.yaml says it is") {
    const cv::Mat map = cv::imread(folder.file("map.png"), cv::IMREAD_UNCHANGED);
    const std::string yaml = read(folder.file("map.yaml"));
    double x = 0, y = 0;
    REQUIRE(std::sscanf(yaml.c_str() + yaml.find("origin"), "origin: [%lf, %lf", &x, &y) == 2);
    const auto pixel = [&](const Eigen::Vector2d& p_world) {
      const Eigen::Vector2d p = run.T_world_map.inverse() * p_world;
      return static_cast<int>(
          map.at<std::uint8_t>(map.rows - 1 - static_cast<int>((p.y() - y) / 0.05),
                               static_cast<int>((p.x() - x) / 0.05)));
    };
    REQUIRE(map.channels() == 1);
    REQUIRE(pixel({10, 2}) == 254);  // the middle of the floor
    REQUIRE(pixel({-1, 4}) == 205);  // outside
    int wall_cells = 0;
    for (double across = -0.1; across < 0.1; across += 0.025)
      wall_cells += pixel({10, 8 + across}) == 0;
    REQUIRE(wall_cells > 0);
  }
  SECTION("semantic.geojson has closed rings and every feature") {
    const auto json = nlohmann::json::parse(read(folder.file("semantic.geojson")));
    std::map<std::string, int> kinds;
    for (const auto& f : json["features"]) {
      ++kinds[f["properties"]["kind"]];
      if (f["geometry"]["type"] == "Polygon")
        REQUIRE(f["geometry"]["coordinates"][0].front() == f["geometry"]["coordinates"][0].back());
    }
    REQUIRE(kinds ==
            std::map<std::string, int>{{"wall", 9}, {"room", 3}, {"door", 3}, {"object", 2}});
    REQUIRE(json["features"][0]["properties"]["id"] ==
            1);  // chunk 0 stands first though it came last
  }
  SECTION("graph.g2o holds each node and edge and fixes the first") {
    const std::string text = read(folder.file("graph.g2o"));
    REQUIRE(count_of(text, "VERTEX_SE2 ") == run.nodes);
    REQUIRE(count_of(text, "EDGE_SE2 ") == run.nodes - 1 + run.loop_edges);
    REQUIRE(count_of(text, "FIX 0\n") == 1);
  }
  SECTION("the page escapes names and asks for nothing but timing.js") {
    const std::string page = read(folder.file("report.html"));
    REQUIRE(count_of(page, "Workshop &lt;A&gt; &amp; co") >= 1);
    REQUIRE(count_of(page, "<A>") == 0);
    REQUIRE(count_of(page, "src=\"") == 1);
    REQUIRE(count_of(page, "http") == 0);
    REQUIRE(count_of(page, folder.path) == 0);
  }
  SECTION("the table names the results") {
    const std::string table = report::table_of(folder.path);
    INFO(table);
    REQUIRE(count_of(table, "9 walls") == 1);
    REQUIRE(count_of(table, folder.path + "/report.html") == 1);
  }
}

TEST_CASE("two reports of one log are byte for byte the same, wherever they stand") {
  const Folder a, b;
  test::write_synthetic_run(a.file("run.lcm"), 200);
  report::write_report({a.path, "", ""});
  report::write_report({b.path, a.file("run.lcm"), ""});
  for (const char* name : kResults) {
    INFO(name);
    REQUIRE(read(a.file(name)) == read(b.file(name)));
  }
}

TEST_CASE("a log that was cut off is reported as far as it goes, and said to be damaged") {
  const Folder folder;
  test::write_synthetic_run(folder.file("run.lcm"), 200);
  fs::resize_file(folder.file("run.lcm"), fs::file_size(folder.file("run.lcm")) / 2);
  REQUIRE(count_of(report::write_report({folder.path, "", ""}), "skipped") == 1);
  const auto s = nlohmann::json::parse(read(folder.file("summary.json")));
  REQUIRE(s["scans"] > 50);
  REQUIRE(s["log_damage"] != "");
  REQUIRE(count_of(read(folder.file("report.html")), "The log is damaged") == 1);
}

TEST_CASE("bytes turned at random in the log never end the report") {
  const Folder folder;
  test::write_synthetic_run(folder.file("run.lcm"), 120);
  const std::string whole = read(folder.file("run.lcm"));
  std::mt19937_64 random(90210);
  for (int round = 0; round < 12; ++round) {
    std::string broken = whole;
    for (int i = 0; i < 300; ++i) broken[random() % broken.size()] = static_cast<char>(random());
    std::ofstream(folder.file("run.lcm"), std::ios::binary) << broken;
    INFO("round " << round);
    REQUIRE(report::write_report({folder.path, "", ""}) != "");
    REQUIRE(nlohmann::json::parse(read(folder.file("summary.json")))["scans"] > 20);
  }
}

TEST_CASE("a log of one scan, and one that nobody estimated anything in, still get a report") {
  const Folder folder;
  test::write_synthetic_run(folder.file("run.lcm"), 1);
  REQUIRE(report::write_report({folder.path, "", ""}) == "");

  LogWriter log(folder.file("run.lcm"));
  for (int i = 0; i < 3; ++i)
    log.write(1000 * i, channel::kLaser, to_message(Scan{1000 * i, {1.0f, 2.0f}, 0, 0.1}));
  log.close();
  REQUIRE(report::write_report({folder.path, "", ""}) == "");
  const auto s = nlohmann::json::parse(read(folder.file("summary.json")));
  REQUIRE(s["scans"] == 3);
  REQUIRE(s["scans_without_pose"] == 3);
  REQUIRE(read_tum(folder.file("path_laser.tum")).empty());
}

TEST_CASE("what cannot be read or written is said by name") {
  const Folder folder;
  REQUIRE_THROWS_WITH(report::write_report({folder.path, "", ""}), Catch::Contains("run.lcm"));
  REQUIRE_THROWS_WITH(report::table_of(folder.path), Catch::Contains("summary.json"));
  std::ofstream(folder.file("run.lcm")) << "this is no log";
  REQUIRE_THROWS_WITH(report::write_report({folder.path, "", ""}), Catch::Contains("LCM"));
  test::write_synthetic_run(folder.file("run.lcm"), 20);
  REQUIRE_THROWS_WITH(report::write_report({folder.file("nowhere"), folder.file("run.lcm"), ""}),
                      Catch::Contains("map.png"));
  std::ofstream(folder.file("world.geojson")) << "{\"features\": 3}";
  REQUIRE_THROWS_WITH(report::write_report({folder.path, "", folder.file("world.geojson")}),
                      Catch::Contains("world.geojson"));
}

TEST_CASE("nodes and updates that a log lost are counted, and those after the gap still stand") {
  const Folder folder;
  test::write_synthetic_run(folder.file("whole.lcm"), 300);
  LogReader in(folder.file("whole.lcm"));
  LogWriter out(folder.file("run.lcm"));
  int nodes = 0, updates = 0;
  for (LogEvent event; in.next(event);) {
    if (event.channel == channel::kNode && ++nodes == 10) continue;
    if (event.channel == channel::kGraph && ++updates == 12) continue;  // holds the edge 10 -> 11
    out.write(event.utime, event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
  }
  out.close();
  REQUIRE(report::write_report({folder.path, "", ""}) == "");
  const auto graph = nlohmann::json::parse(read(folder.file("summary.json")))["graph"];
  REQUIRE(graph["nodes_missing_in_log"] == 1);
  REQUIRE(graph["updates_missing_in_log"] == 1);
  REQUIRE(graph["nodes"] == nodes);  // the last update says where the lost node is
  REQUIRE(graph["edges"] == nodes - 2);
  REQUIRE(count_of(read(folder.file("report.html")), "nodes are missing in the log") == 1);
}

TEST_CASE("another session's graph in the same log takes the place of the first") {
  const Folder folder;
  test::write_synthetic_run(folder.file("first.lcm"), 200);
  test::write_synthetic_run(folder.file("second.lcm"), 100, 0, 5'000'000'000);
  LogWriter out(folder.file("run.lcm"));
  for (const char* name : {"first.lcm", "second.lcm"}) {
    LogReader in(folder.file(name));
    for (LogEvent event; in.next(event);)
      out.write(event.utime, event.channel, event.bytes.data(),
                static_cast<int>(event.bytes.size()));
  }
  out.close();
  report::write_report({folder.path, "", ""});
  const auto s = nlohmann::json::parse(read(folder.file("summary.json")));
  REQUIRE(s["scans"] == 300);
  REQUIRE(s["scans_without_pose"] == 0);
  REQUIRE(s["graph"]["edges_without_node"] == 0);
  // Both drove the same way: the first session's path stays where it was estimated.
  const auto lines = read_tum(folder.file("path.tum"));
  REQUIRE(lines.size() == 300);
  for (int i = 0; i < 100; ++i) REQUIRE(std::abs(lines[i][1] - lines[200 + i][1]) < 0.1);
}

TEST_CASE("a true world is drawn under what was found") {
  const Folder folder;
  test::write_synthetic_run(folder.file("run.lcm"), 100);
  std::ofstream(folder.file("world.geojson")) << test::synthetic_world_geojson();
  report::write_report({folder.path, "", folder.file("world.geojson")});
  REQUIRE(count_of(read(folder.file("report.html")), "class=\"true-wall\"") == 9);
}

TEST_CASE("runs are compared by their errors, and each figure stands on its own") {
  const Folder one, two;
  test::write_synthetic_run(one.file("run.lcm"), 300, 7);
  test::write_synthetic_run(two.file("run.lcm"), 400, 8);
  const std::string page = report::comparison_page({one.path, two.path});
  CHECK(count_of(page, "class=\"curve run0\"") == 2);  // position and heading
  CHECK(count_of(page, "class=\"curve run1\"") == 2);
  CHECK(count_of(page, "data:image/svg+xml;base64,") == 2);
  CHECK(count_of(page, "<script") == 0);
  CHECK_THROWS_WITH(report::comparison_page({one.path, one.path + "/none"}),
                    Catch::Contains("none"));

  REQUIRE(report::write_report({one.path, "", ""}) == "");
  for (const char* name : {"map", "error_position", "error_heading", "verdicts"}) {
    const std::string svg = read(one.file("figures/" + std::string(name) + ".svg"));
    INFO(name);
    CHECK(svg.rfind("<svg xmlns=\"http://www.w3.org/2000/svg\"", 0) == 0);
    CHECK(count_of(svg, "var(") == 0);
    CHECK(count_of(svg, "</svg>") == 1);
  }
}
