// SPDX-License-Identifier: BSD-3-Clause
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <modslam/pose_estimate_t.hpp>
#include <nlohmann/json.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "common/bus/run_log.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
namespace fs = std::filesystem;

namespace {

struct Evaluate {
  fs::path folder = fs::temp_directory_path() / "modslam_evaluate_test";
  std::string words;

  Evaluate() {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  ~Evaluate() { fs::remove_all(folder); }

  std::string file(const std::string& name, const std::string& text = "") const {
    if (!text.empty()) std::ofstream(folder / name) << text;
    return (folder / name).string();
  }
  int run(const std::string& options) {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "modslam-evaluate";
    const int status = std::system(
        ("'" + program.string() + "' " + options + " > '" + file("words") + "' 2>&1").c_str());
    std::ifstream in(file("words"));
    words.assign(std::istreambuf_iterator<char>(in), {});
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  nlohmann::json json() const { return nlohmann::json::parse(std::ifstream(folder / "out.json")); }
};

/// The robot drives 10 m along the middle of a corridor of 2 m that starts at (5, 1) in the world;
/// its path is 1 % too long. The laser sits 0.2 m ahead and sees one point on each side.
std::string write_run(const Evaluate& at) {
  const Pose2 T_world_start(5, 1, kPi / 2);
  LogWriter log(at.file("run.lcm"));
  SensorInfo sensor;
  sensor.T_base_laser = Pose2(0.2, 0, 0);
  log.write(0, channel::kSensorInfo, to_message(sensor, 0));
  std::string path;
  for (int i = 0; i <= 100; ++i) {
    const std::int64_t utime = i * 100'000;
    const Pose2 T_map_base(0.1 * i * 1.01, 0, 0);
    log.write(utime, channel::kGroundTruth,
              to_message(TimedPose{utime, T_world_start * Pose2(0.1 * i, 0, 0), 0}));
    Scan scan;
    scan.utime = utime;
    scan.rad0 = -kPi / 2;
    scan.radstep = kPi;
    scan.ranges_m = {1.0f, 1.0f};
    log.write(utime, channel::kLaser, to_message(scan));
    pose_estimate_t pose{};
    pose.utime = utime;
    put(pose.T_map_base, T_map_base);
    log.write(utime, channel::kPose, pose);
    path += std::to_string(0.1 * i) + " " + std::to_string(T_map_base.x) + " 0 0 0 0 0 1\n";
  }
  log.write(1, channel::kLaser, "junk", 4);
  log.close();
  return at.file("path.tum", path);
}

std::string wall(double ax, double ay, double bx, double by) {
  return R"({"properties":{"kind":"wall"},"geometry":{"type":"LineString","coordinates":[[)" +
         std::to_string(ax) + "," + std::to_string(ay) + "],[" + std::to_string(bx) + "," +
         std::to_string(by) + "]]}}";
}
std::string collection(const std::string& features) {
  return R"({"type":"FeatureCollection","features":[)" + features + "]}";
}

}  // namespace

TEST_CASE("evaluate scores a path against the truth of its log", "[evaluate]") {
  Evaluate e;
  const std::string path = write_run(e);
  REQUIRE(e.run("--truth " + e.file("run.lcm") + " --path " + path + " --json " +
                e.file("out.json")) == 0);
  const auto truth = e.json()["truth"];
  CHECK(truth["first_pose"]["position_m"]["max"].get<double>() == Approx(0.1).margin(1e-4));
  CHECK(truth["least_squares"]["position_m"]["max"].get<double>() == Approx(0.05).margin(1e-4));
  CHECK(truth["relative"][1]["translation_m"]["mean"].get<double>() == Approx(0.05).margin(2e-3));
  CHECK(truth["first_pose"]["over_time"]["stamp_s"].size() == 101);
  CHECK_THAT(e.words, Catch::Contains("1 messages refused"));
}

TEST_CASE("evaluate scores walls that the run saw, aligned by its first pose", "[evaluate]") {
  Evaluate e;
  write_run(e);
  // World: both walls of the corridor are 20 m long; beams ended on the first 10 m, from 0.2 m on.
  const std::string world =
      e.file("world.geojson", collection(wall(4, 0, 4, 20) + "," + wall(6, 0, 6, 20)));
  const std::string found = e.file("found.geojson", collection(wall(-1, 1, 10.5, 1)));
  const std::string options =
      "--semantic " + found + " --world-truth " + world + " --json " + e.file("out.json");
  REQUIRE(e.run(options + " --log " + e.file("run.lcm")) == 0);
  auto walls = e.json()["semantics"]["walls"];
  CHECK(walls["visible_m"].get<double>() == Approx(20.4).margin(0.2));
  CHECK(walls["at"][0]["recall"].get<double>() == Approx(0.5).margin(0.01));
  CHECK(walls["at"][0]["precision"].get<double>() == Approx(1).margin(0.01));
  REQUIRE(e.run(options + " --align 5,1,1.5707963") == 0);
  walls = e.json()["semantics"]["walls"];
  CHECK(walls["visible_m"].get<double>() == Approx(40));
  CHECK(walls["at"][0]["precision"].get<double>() == Approx(1).margin(0.01));
}

TEST_CASE("evaluate scores relations from files", "[evaluate]") {
  Evaluate e;
  const std::string options = "--relations " + e.file("r", "1 2 1 0 0 0 0 0\n") + " --times " +
                              e.file("t.csv", "scan_index,ipc_timestamp,exact\n0,1,1\n1,2,1\n") +
                              " --path " + e.file("p.tum", "1 0 0 0 0 0 0 1\n2 1.5 0 0 0 0 0 1\n") +
                              " --json " + e.file("out.json");
  REQUIRE(e.run(options) == 0);
  CHECK(e.json()["relations"]["exact"]["translation_m"]["mean"].get<double>() == Approx(0.5));
}

TEST_CASE("evaluate ends in a sentence that names the file when its input is wrong", "[evaluate]") {
  Evaluate e;
  const std::string path = write_run(e), junk = e.file("junk", "junk\n");
  for (const std::string& options :
       {"--truth " + junk + " --path " + path, "--truth " + e.file("run.lcm") + " --path " + junk,
        "--semantic " + junk + " --world-truth " + junk,
        "--truth " + e.file("run.lcm") + " --path " + e.file("junk")}) {
    INFO(options);
    CHECK(e.run(options) == 1);
    CHECK_THAT(e.words, Catch::Contains("junk: "));
  }
  CHECK(e.run("") == 1);
  CHECK(e.run("--truth " + e.file("run.lcm")) != 0);
}
