// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/relations.hpp"

#include <filesystem>
#include <iostream>

#include "common/formats/file_bytes.hpp"
#include "common/formats/text_fields.hpp"
#include "common/formats/text_log.hpp"
#include "tests/support/data.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

const ScanTimes kFourScans({10, 11, 12, 13}, {true, true, false, true});

IndexedPath straight(double step_m) {
  return {{0, 1, 2, 3}, {{0, 0, 0}, {step_m, 0, 0}, {2 * step_m, 0, 0}, {3 * step_m, 0, 0}}};
}

std::string data(const std::string& name) { return shared_file("data/slam/" + name); }

/// Columns scan_index, ipc_timestamp, x, y, theta.
IndexedPath parse_gmapping(const std::string& text) {
  IndexedPath path;
  for_each_line(text, [&](std::size_t number, std::string_view line) {
    if (number == 1) return;
    TextFields fields(line, ",\r");
    path.indices.push_back(fields.number("scan_index"));
    fields.number("ipc_timestamp");
    path.poses.push_back(fields.pose("pose"));
  });
  return path;
}

}  // namespace

TEST_CASE("A path that moves as the relations say has no error", "[evaluation]") {
  const auto s =
      score_relations({{10, 13, {3, 0, 0}}, {10, 12, {2, 0, 0}}}, kFourScans, straight(1));
  CHECK(s.all.translation_m.count == 2);
  CHECK(s.all.translation_m.max == Approx(0).margin(1e-12));
  CHECK(s.exact.translation_m.count == 1);
}

TEST_CASE("A path that is 10 % long shows 0.3 m over 3 m, whatever frame it is in",
          "[evaluation]") {
  IndexedPath moved = straight(1.1);
  for (Pose2& pose : moved.poses) pose = Pose2(5, -7, 2.5) * pose;
  const auto s = score_relations({{10, 13, {3, 0, 0.5}}}, kFourScans, moved);
  CHECK(s.all.translation_m.mean == Approx(0.3));
  CHECK(s.all.rotation_deg.mean == Approx(0.5 * 180 / kPi));
}

TEST_CASE("A stamp between two scans is interpolated, one outside the log is counted as unplaced",
          "[evaluation]") {
  const auto s = score_relations({{10.5, 12.5, {2, 0, 0}}, {9, 11, {}}, {11, 14, {}}}, kFourScans,
                                 straight(1));
  CHECK(s.all.translation_m.count == 1);
  CHECK(s.all.translation_m.max == Approx(0).margin(1e-12));
  CHECK(s.exact.translation_m.count == 0);
  CHECK(s.unplaced == 2);
}

TEST_CASE("Where stamps step back, a stamp is placed at its own scan or in the tightest pair",
          "[evaluation]") {
  const ScanTimes times({10, 12, 11, 11.4, 13}, std::vector<bool>(5, true));
  CHECK(times.place(11)->index == 2);
  CHECK(times.place(12)->exact);
  CHECK(times.place(11.2)->index == Approx(2.5));
  CHECK_FALSE(times.place(11.2)->exact);
  CHECK(times.place(12.2)->index == Approx(3.5));
  CHECK_FALSE(times.place(9.9));
}

TEST_CASE("Scan times and relations name the line that is wrong", "[evaluation]") {
  CHECK(ScanTimes::parse("scan_index,ipc_timestamp,exact\n0,1.5,1\n1,2.5,0\n").place(2.5)->exact ==
        false);
  CHECK_THROWS_WITH(ScanTimes::parse("scan_index,ipc_timestamp\n0,1\n2,3\n"),
                    Catch::Contains("line 3"));
  CHECK_THROWS_WITH(ScanTimes::parse("0,nan\n"), Catch::Contains("line 1"));
  CHECK_THROWS_WITH(ScanTimes::parse(""), Catch::Contains("no scan time"));
  CHECK_THROWS_WITH(parse_relations("1 2 0 0 0 0 0 0\n1 2 3\n"), Catch::Contains("line 2"));
}

TEST_CASE("Path lines are scans when as many, else they are found by stamp in file order",
          "[evaluation]") {
  const ScanTimes times({10, 12, 11, 13}, std::vector<bool>(4, true));
  CHECK(index_path({{10, {}}, {12, {}}, {11, {}}, {13, {}}}, times).indices ==
        std::vector<double>{0, 1, 2, 3});
  CHECK(index_path({{10, {}}, {11, {}}, {13, {}}}, times).indices == std::vector<double>{0, 2, 3});
  const ScanTimes close({10, 10.0004, 10.0002, 13}, std::vector<bool>(4, true));
  CHECK(index_path({{10.0002, {}}, {13, {}}}, close).indices == std::vector<double>{2, 3});
  CHECK_THROWS_WITH(index_path({{10, {}}, {11, {}}, {12, {}}, {13, {}}}, times),
                    Catch::Contains("pose 2"));
  CHECK_THROWS_WITH(index_path({{10, {}}, {99, {}}}, times), Catch::Contains("no later scan"));
}

TEST_CASE("Known paths through public logs score as published for this metric",
          "[evaluation][data]") {
  struct Known {
    const char* name;
    const char* log;
    double mean_m, std_m, within_m, odometry_m, odometry_std_m;
  };
  // GMapping's figures are those that others measured; on intel they hang on how a stamp finds its
  // scan, hence the tolerance. The odometry's are our own: others give 7.38 +- 14.4 for intel,
  // which agrees, and 6.51 +- 13.7 for fr079, which no way of placing the stamps reproduces.
  for (const Known& k : {Known{"intel", "intel.clf.xz", 0.078, 0.083, 0.003, 7.418, 14.440},
                         Known{"fr079", "fr079.clf.xz", 0.058, 0.042, 0.001, 6.987, 14.222}}) {
    const std::string folder = std::string(k.name) + "/" + k.name;
    if (!std::filesystem::exists(data(folder + ".relations"))) {
      WARN("no data of " << k.name << ": skipped");
      continue;
    }
    const auto relations = parse_relations(read_file_bytes(data(folder + ".relations")).bytes);
    const auto times = ScanTimes::parse(read_file_bytes(data(folder + ".times.csv.xz")).bytes);
    const auto gmapping =
        parse_gmapping(read_file_bytes(data(folder + ".gmapping_poses.csv.xz")).bytes);
    const auto s = score_relations(relations, times, gmapping);
    CHECK(s.all.translation_m.mean == Approx(k.mean_m).margin(k.within_m));
    CHECK(s.all.translation_m.std == Approx(k.std_m).margin(k.within_m));

    const Recording log =
        read_text_log(read_file_bytes(data(std::string(k.name) + "/" + k.log)).bytes);
    REQUIRE(log.scans.size() == times.size());
    IndexedPath odometry;
    for (std::size_t i = 0; i < log.scans.size(); ++i) {
      odometry.indices.push_back(static_cast<double>(i));
      odometry.poses.push_back(log.scans[i].T_odom_base);
    }
    const auto raw = score_relations(relations, times, odometry);
    CHECK(raw.unplaced == 0);
    CHECK(raw.all.translation_m.mean == Approx(k.odometry_m).margin(0.01));
    CHECK(raw.all.translation_m.std == Approx(k.odometry_std_m).margin(0.01));
    std::cout << k.name << ": gmapping " << s.all.translation_m.mean << "+-"
              << s.all.translation_m.std << " m (" << s.unplaced << " unplaced), odometry "
              << raw.all.translation_m.mean << "+-" << raw.all.translation_m.std << " m\n";
  }
}
