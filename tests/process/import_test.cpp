// SPDX-License-Identifier: BSD-3-Clause
#include <sys/wait.h>

#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pose_t.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <modslam/sensor_info_t.hpp>

#include "common/bus/log.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;
namespace fs = std::filesystem;

namespace {

/// Runs modslam-import beside this test program.
struct Import {
  fs::path folder = fs::temp_directory_path() / "modslam_import_test";
  std::string words;

  Import() {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  ~Import() { fs::remove_all(folder); }

  int run(const std::string& input, const std::string& options = "") {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "modslam-import";
    const std::string command = "'" + program.string() + "' '" + input + "' '" +
                                (folder / "out.lcm").string() + "' " + options + " > '" +
                                (folder / "words").string() + "' 2>&1";
    const int status = std::system(command.c_str());
    std::ifstream in(folder / "words");
    words.assign(std::istreambuf_iterator<char>(in), {});
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  int run_text(const std::string& text, const std::string& options = "") {
    std::ofstream(folder / "in.log") << text;
    return run((folder / "in.log").string(), options);
  }
  std::vector<LogEvent> events() const {
    LogReader reader((folder / "out.lcm").string());
    std::vector<LogEvent> all;
    for (LogEvent event; reader.next(event);) all.push_back(event);
    return all;
  }
};

template <class Message>
Message decoded(const LogEvent& event) {
  Message message{};
  REQUIRE(message.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())) ==
          static_cast<int>(event.bytes.size()));
  return message;
}

std::string sweep(double stamp) {
  return "FLASER 4 1 2 3 4 0 0 0 " + std::to_string(stamp) + " 0 0 " + std::to_string(stamp) +
         " h 0\n";
}

const char* const kRawlog =
    "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";

}  // namespace

TEST_CASE("An imported log opens with SENSOR_INFO and pairs ODOMETRY with LASER in file order",
          "[import]") {
  Import import;
  REQUIRE(import.run_text(sweep(10) + sweep(11) + sweep(10.5) + sweep(16),
                          "--laser-x 0.09 --laser-yaw 0.5") == 0);
  const std::vector<LogEvent> events = import.events();
  std::string order;
  std::int64_t before = 0;
  std::vector<std::int64_t> laser_utimes;
  for (const LogEvent& event : events) {
    order += event.channel[0];
    CHECK(event.utime >= before);
    before = event.utime;
    if (event.channel == "LASER") {
      laser_utimes.push_back(decoded<bot_core::planar_lidar_t>(event).utime);
      CHECK(decoded<bot_core::pose_t>(*(&event - 1)).utime == laser_utimes.back());
      CHECK(decoded<bot_core::pose_t>(*(&event - 1)).pos[0] ==
            Approx(1e-6 * static_cast<double>(laser_utimes.back())));
    }
  }
  CHECK(order == "SOLOLOLSOL");
  CHECK(laser_utimes == std::vector<std::int64_t>{10'000'000, 11'000'000, 10'500'000, 16'000'000});
  const auto sensor = decoded<sensor_info_t>(events[0]);
  CHECK(sensor.T_base_sensor[0] == 0.09);
  CHECK(sensor.T_base_sensor[2] == 0.5);
  CHECK_FALSE(sensor.no_return_is_free);
  CHECK_THAT(import.words, Catch::Contains("1 stamps step back"));
}

TEST_CASE("The header's laser offset counts only where none is given", "[import]") {
  Import import;
  const std::string text = "PARAM robot_frontlaser_offset -0.04 nohost 0\n" + sweep(1);
  REQUIRE(import.run_text(text) == 0);
  CHECK(decoded<sensor_info_t>(import.events()[0]).T_base_sensor[0] == -0.04);
  REQUIRE(import.run_text(text, "--laser-x 0.08 --no-return 3.5") == 0);
  CHECK(decoded<sensor_info_t>(import.events()[0]).T_base_sensor[0] == 0.08);
  CHECK(decoded<sensor_info_t>(import.events()[0]).range_max_m == Approx(3.5 * 0.995));
}

TEST_CASE("A broken line is named, and fails the import only with --strict", "[import]") {
  Import import;
  const std::string text = sweep(1) + "FLASER 4 1 2 x 4 0 0 0 0 0 0 2 h 0\n" + sweep(3);
  CHECK(import.run_text(text) == 0);
  CHECK_THAT(import.words, Catch::Contains("line 2") && Catch::Contains("1 entries skipped"));
  CHECK(import.run_text(text, "--strict") == 1);
  CHECK(import.run_text(sweep(1), "--strict") == 0);
}

TEST_CASE(
    "What is no log, empty or absent ends in a sentence and exit code 1, and leaves no output",
    "[import]") {
  Import import;
  for (const char* text : {"", "hello\n", "FLASER 4 1 2\n"}) {
    CHECK(import.run_text(text) == 1);
    CHECK_THAT(import.words, Catch::Contains("in.log: "));
    CHECK_FALSE(fs::exists(import.folder / "out.lcm"));
  }
  CHECK(import.run((import.folder / "absent").string()) == 1);
  CHECK_THAT(import.words, Catch::Contains("no such file"));
  std::ofstream(import.folder / "no.rawlog") << "hello";
  CHECK(import.run((import.folder / "no.rawlog").string()) == 1);
  CHECK_THAT(import.words, Catch::Contains("is it a whole MRPT rawlog"));
}

TEST_CASE(
    "A rawlog gives its scans with the mount of its objects; a cut one gives what is there and "
    "says so",
    "[import]") {
  if (!fs::exists(kRawlog)) {
    WARN("package mrpt-common is not installed: skipped");
    return;
  }
  Import import;
  REQUIRE(import.run(kRawlog) == 0);
  CHECK_THAT(import.words, Catch::Contains("225 scans of 361 beams, 59.1 s") &&
                               Catch::Contains("0 entries skipped"));
  CHECK(decoded<sensor_info_t>(import.events()[0]).T_base_sensor[0] == Approx(0.78));
  const fs::path cut = import.folder / "cut.rawlog";
  fs::copy_file(kRawlog, cut);
  fs::resize_file(cut, 60000);
  CHECK(import.run(cut.string()) == 0);
  CHECK_THAT(import.words, Catch::Contains("79 scans") && Catch::Contains("ends early"));
  CHECK(import.run(cut.string(), "--strict") == 1);
  fs::resize_file(cut, 500);
  CHECK(import.run(cut.string()) == 1);
}
