// SPDX-License-Identifier: BSD-3-Clause
#include "procs/doctor/diagnosis.hpp"

#include <catch2/catch.hpp>

using namespace modslam;
using namespace modslam::doctor;

namespace {

bool says(const std::vector<Finding>& findings, const std::string& words, bool serious) {
  for (const Finding& finding : findings)
    if (finding.words.find(words) != std::string::npos && finding.serious == serious) return true;
  return false;
}

/// Ten seconds of a laser at 10 Hz and odometry at 20 Hz that is `lag_us` behind.
Run healthy(std::int64_t lag_us = 0) {
  Run run;
  run.listened_s = 10;
  for (int k = 0; k < 200; ++k) {
    const double now_s = 0.05 * k;
    run.odometry.take(50'000 * k - lag_us, now_s);
    if (k % 2) continue;
    run.laser.take(50'000 * k, now_s);
    run.pose.take(50'000 * k, now_s);
    run.odometry_behind_s.push_back(1e-6 * static_cast<double>(run.laser.last_utime - run.odometry.last_utime));
  }
  run.beams = 1000;
  run.beams_without_return = 300;
  run.expected = {"scan_matcher"};
  run.status["scan_matcher"].state = process_status_t::RUNNING;
  run.pids["scan_matcher"] = {7};
  return run;
}

}  // namespace

TEST_CASE("the doctor finds nothing wrong with a healthy machine and a healthy run") {
  Machine machine;
  machine.receive_buffer = 4 << 20;
  REQUIRE(diagnose(machine).empty());
  REQUIRE(diagnose(healthy()).empty());
  REQUIRE(healthy().laser.rate_hz() == Approx(10));
}

TEST_CASE("the doctor names what is wrong with the machine") {
  Machine machine;
  machine.multicast = "this machine has no multicast route";
  machine.receive_buffer = 208 << 10;
  machine.disk_free = 3e7;
  machine.folder = "/somewhere";
  machine.folder_writable = false;
  machine.java = false;
  const auto findings = diagnose(machine);
  REQUIRE(says(findings, "no multicast route", true));
  REQUIRE(says(findings, "208 kB", false));
  REQUIRE(says(findings, "disk is full: 30 MB", true));
  REQUIRE(says(findings, "/somewhere cannot be written", true));
  REQUIRE(says(findings, "no java", false));
  machine.disk_free = 5e8;
  REQUIRE(says(diagnose(machine), "nearly full: 500 MB", false));
}

TEST_CASE("the doctor tells by how much odometry lags the laser") {
  REQUIRE(says(diagnose(healthy(140'000)), "Odometry lags the laser by 140 ms", true));
  REQUIRE(says(diagnose(healthy(-150'000)), "The laser lags odometry by 150 ms", false));
}

TEST_CASE("the doctor tells who is silent, and since when") {
  Run run = healthy();
  run.laser.last_heard_s = 7;
  run.status.clear();
  run.odometry = {};
  const auto findings = diagnose(run);
  REQUIRE(says(findings, "The laser has been silent for 3.0 s", true));
  REQUIRE(says(findings, "Odometry: nothing came within 10 s", true));
  REQUIRE(says(findings, "scan_matcher has said nothing for 10 s", true));
  Run deaf = healthy();
  deaf.pose = {};
  REQUIRE(says(diagnose(deaf), "there is no POSE", true));
  REQUIRE(says(diagnose(Run{}), "The laser: nothing came", true));
}

TEST_CASE("the doctor tells of stamps that step back, blind lasers, losses, trouble and a second robot") {
  Run run = healthy();
  run.laser.take(run.laser.last_utime - 1000, 9.9);
  run.laser.take(run.laser.last_utime, 9.95);
  run.beams_without_return = 950;
  process_status_t& status = run.status["scan_matcher"];
  channel_count_t in{};
  in.received = 900;
  in.gaps = 100;
  in.bad = 2;
  status.inputs = {in};
  status.state = process_status_t::TROUBLED;
  status.words = "cannot go on";
  status.latency_p99_us = 250'000;
  run.pids["scan_matcher"] = {7, 8};
  const auto findings = diagnose(run);
  REQUIRE(says(findings, "stamps step back (1 times", false));
  REQUIRE(says(findings, "1 stamps came twice", false));
  REQUIRE(says(findings, "95 % of the laser's beams", true));
  REQUIRE(says(findings, "lost 100 of 1000 messages", true));
  REQUIRE(says(findings, "dropped 2 messages", false));
  REQUIRE(says(findings, "in trouble: cannot go on", true));
  REQUIRE(says(findings, "up to 250 ms", false));
  REQUIRE(says(findings, "2 processes call themselves scan_matcher", true));
}
