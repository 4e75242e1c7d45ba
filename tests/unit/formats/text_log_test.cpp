// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/text_log.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "common/formats/file_bytes.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

std::string flaser(int beams, const std::string& range,
                   const std::string& tail = "1 2 0.5 3 4 0.25 100.5 host 0.1") {
  std::string line = "FLASER " + std::to_string(beams);
  for (int i = 0; i < beams; ++i) line += " " + range;
  return line + " " + tail + "\n";
}

}  // namespace

TEST_CASE("A FLASER line gives ranges, bearings, the odometry pose and the ipc stamp",
          "[formats]") {
  const Recording r = read_text_log("# FLASER 3 is a comment\n" + flaser(181, "2.5"));
  REQUIRE(r.scans.size() == 1);
  CHECK(r.scans[0].scan.ranges_m == std::vector<float>(181, 2.5f));
  CHECK(r.scans[0].scan.utime == 100'500'000);
  CHECK_THAT(r.scans[0].T_odom_base, IsNear({3, 4, 0.25}, 1e-12, 1e-12));
  CHECK(r.broken_entries == 0);
}

TEST_CASE("An even number of beams ends one step before +90 degrees, an odd one at it",
          "[formats]") {
  for (const auto& [beams, last_deg] :
       {std::pair{180, 89.0}, {360, 89.5}, {181, 90.0}, {361, 90.0}}) {
    const auto [rad0, radstep] = flaser_bearings(static_cast<std::size_t>(beams));
    CHECK(rad0 == Approx(-kPi / 2));
    CHECK((rad0 + (beams - 1) * radstep) * 180 / kPi == Approx(last_deg));
  }
}

TEST_CASE("A ROBOTLASER1 line states its own geometry and the laser's mount", "[formats]") {
  const Recording r = read_text_log(
      "ROBOTLASER1 0 -1.0 2.0 0.5 50 0.01 0 3 1 -2 3 1 9 1.3 2 0 1 2 0 0 0 0 0 0 7.25 host 0.1\n");
  REQUIRE(r.scans.size() == 1);
  CHECK(r.scans[0].scan.rad0 == -1.0);
  CHECK(r.scans[0].scan.radstep == 0.5);
  CHECK(r.scans[0].scan.ranges_m == std::vector<float>{1, 0, 3});
  CHECK(r.negative_ranges == 1);
  CHECK(r.range_limit_m == 50);
  REQUIRE(find_mount(r));
  CHECK_THAT(*find_mount(r), IsNear({0.3, 0, 0}, 1e-9, 1e-9));
}

TEST_CASE("A Wean line is in centimetres and states the mount", "[formats]") {
  std::string line = "L 100 200 1.5707963267948966 100 225 1.5707963267948966";
  for (int i = 0; i < 180; ++i) line += " 66";
  const Recording r = read_text_log("O 100 200 1.5 0.01\n" + line + " 0.025863\n");
  REQUIRE(r.scans.size() == 1);
  CHECK(r.scans[0].scan.ranges_m[7] == Approx(0.66));
  CHECK(r.scans[0].scan.utime == 25863);
  CHECK_THAT(r.scans[0].T_odom_base, IsNear({1, 2, kPi / 2}, 1e-9, 1e-9));
  CHECK_THAT(*find_mount(r), IsNear({0.25, 0, 0}, 1e-9, 1e-9));
  CHECK(r.odometry_entries == 1);
}

TEST_CASE("Broken lines are counted, named by number and skipped; good ones around them stay",
          "[formats]") {
  const std::string good = flaser(180, "2"), tail = "0 0 0 0 0 0 1 host 1";
  const std::string broken[] = {
      "FLASER 181" + good.substr(10),               // one reading too few
      flaser(180, "nan"),                           //
      flaser(180, "inf"),                           //
      flaser(180, "2m"),                            //
      "FLASER 99999999999 1 " + tail + "\n",        //
      "FLASER -4 1 " + tail + "\n",                 //
      "FLASER\n",                                   //
      flaser(180, "2", "0 0 nan 0 0 0 1 host 1"),   //
      flaser(180, "2", "0 0 0 0 0 0 -1 host 1"),    // before time began
      flaser(180, "2", "0 0 0 0 0 0 1 host 1 9"),   // one field too many
      "ODOM 1 2\n",                                 //
      "ROBOTLASER1 0 -1 2 0.5 50 0.01 0 3 1 2 3\n"  //
  };
  for (const std::string& line : broken) {
    INFO(line.substr(0, 60));
    const Recording r = read_text_log(good + line + good);
    CHECK(r.scans.size() == 2);
    CHECK(r.broken_entries == 1);
    REQUIRE(r.complaints.size() == 1);
    CHECK(r.complaints[0].rfind("line 2 ", 0) == 0);
  }
}

TEST_CASE("Only the first few broken lines are said but all are counted", "[formats]") {
  std::string text = flaser(180, "2");
  for (int i = 0; i < 100; ++i) text += "FLASER 7 7\n";
  const Recording r = read_text_log(text);
  CHECK(r.broken_entries == 100);
  CHECK(r.complaints.size() == 5);
}

TEST_CASE("A text without a usable sweep is an error that says what was found", "[formats]") {
  CHECK_THROWS_WITH(read_text_log("hello\n"), Catch::Contains("'hello'"));
  CHECK_THROWS_WITH(read_text_log("FLASER 2 1 x 0 0 0 0 0 0 1 h 1\n"),
                    Catch::Contains("line 1") && Catch::Contains("'x'"));
  CHECK_THROWS_AS(read_text_log(""), std::runtime_error);
  CHECK_THROWS_AS(read_text_log(std::string("\x7f\x45\0\xff\n\n\0", 8)), std::runtime_error);
}

TEST_CASE("Stamps that step back or repeat are kept in file order and counted", "[formats]") {
  std::string text;
  for (const char* stamp : {"10", "11", "10.5", "10.5"})
    text += flaser(4, "2", std::string("0 0 0 0 0 0 ") + stamp + " h 1");
  const RecordingSummary s = summarize(read_text_log(text));
  CHECK(s.steps_back == 1);
  CHECK(s.repeated_stamps == 1);
  CHECK(s.largest_step_back_s == Approx(0.5));
  CHECK(s.duration_s == Approx(1.0));
}

TEST_CASE("The no-return value is the largest one that stands out", "[formats]") {
  const auto with = [](int at_8191, int at_8183, bool far_wall) {
    std::string text;
    for (int scan = 0; scan < 20; ++scan) {
      text += "FLASER 180";
      for (int i = 0; i < 180; ++i) {
        const double honest =
            1 + 0.01 * ((i * 37 + scan * 11) % 900) + (far_wall && i == 5 ? 40 + 0.1 * scan : 0);
        const double range = i < at_8191 ? 81.91 : i < at_8191 + at_8183 ? 81.83 : honest;
        text += " " + std::to_string(range);
      }
      text += " 0 0 0 0 0 0 " + std::to_string(scan) + " h 1\n";
    }
    return read_text_log(text);
  };
  CHECK(find_no_return(with(4, 0, false)) == 81.91);
  CHECK(find_no_return(with(4, 3, true)) == 81.91);
  CHECK_FALSE(find_no_return(with(0, 0, false)));
  CHECK_FALSE(find_no_return(with(0, 0, true)));
  const Recording both = with(4, 3, false);
  const SensorInfo sensor = sensor_of(both, {}, find_no_return(both));
  CHECK_FALSE(is_return(81.83f, sensor));
  CHECK(is_return(79.0f, sensor));
  CHECK_FALSE(sensor.no_return_is_free);
}

TEST_CASE("Without a no-return value every range is a return", "[formats]") {
  const Recording r = read_text_log("FLASER 4 1 2 3 55 0 0 0 0 0 0 1 h 1\n");
  CHECK_FALSE(find_no_return(r));
  for (const float range_m : r.scans[0].scan.ranges_m)
    CHECK(is_return(range_m, sensor_of(r, {}, {})));
}

TEST_CASE("Compressed files read as what is in them; a cut one says so", "[formats]") {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / "modslam it's a test";
  std::filesystem::create_directories(folder);
  const std::string plain = (folder / "a.log").string();
  std::string text;
  for (int i = 0; i < 5000; ++i) text += "line " + std::to_string(i * 7919 % 5000) + "\n";
  std::ofstream(plain) << text;
  for (const char* tool : {"gzip", "xz"}) {
    const std::string packed = plain + "." + tool;
    if (std::system((std::string(tool) + " -c \"" + plain + "\" > \"" + packed + "\"").c_str()) !=
        0) {
      WARN(tool << " is not installed: skipped");
      continue;
    }
    CHECK(read_file_bytes(packed).bytes == text);
    CHECK(read_file_bytes(packed).damage.empty());
    std::filesystem::resize_file(packed, std::filesystem::file_size(packed) * 3 / 4);
    try {
      const FileBytes cut = read_file_bytes(packed);
      CHECK(cut.bytes == text.substr(0, cut.bytes.size()));
      CHECK_FALSE(cut.damage.empty());
    } catch (const std::runtime_error& error) {  // nothing of it could be unpacked
      CHECK_THAT(error.what(), Catch::Contains(packed));
    }
  }
  CHECK(read_file_bytes(plain).bytes == text);
  std::ofstream(folder / "empty");
  CHECK_THROWS_WITH(read_file_bytes((folder / "empty").string()), Catch::Contains("is empty"));
  CHECK_THROWS_WITH(read_file_bytes((folder / "absent").string()), Catch::Contains("no such file"));
  CHECK_THROWS_AS(read_file_bytes(folder.string()), std::runtime_error);
  std::filesystem::remove_all(folder);
}
