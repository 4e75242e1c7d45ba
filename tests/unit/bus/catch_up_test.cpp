// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/catch_up.hpp"

#include <bot_core/pose_t.hpp>
#include <catch2/catch.hpp>
#include <chrono>
#include <modslam/process_status_t.hpp>

#include "common/bus/bus.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace modslam;

namespace {

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// A run's log whose events lie a millisecond apart and end now.
struct RunLog {
  explicit RunLog(const std::string& file) : path(file), writer(file, LogWriter::kAppend) {}
  void say(const std::string& channel, std::int64_t utime) {
    bot_core::pose_t message{};
    message.utime = utime;
    writer.write(at_us += 1000, channel, message);
    writer.flush();
  }
  void word(std::int32_t pid) {
    process_status_t status{};
    status.name = "walker";
    status.pid = pid;
    writer.write(now_us(), "STATUS", status);
    writer.flush();
  }
  std::string path;
  LogWriter writer;
  std::int64_t at_us = now_us() - 1'000'000;
};

std::vector<std::int64_t> utimes(const Missed& missed, const std::string& channel) {
  std::vector<std::int64_t> found;
  for (const LogEvent& event : missed.events) {
    bot_core::pose_t message{};
    if (event.channel == channel && message.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())) > 0)
      found.push_back(message.utime);
  }
  return found;
}

}  // namespace

TEST_CASE("what was missed is all behind the last handled message and before the first word of the new life") {
  const test::TemporaryFolder folder;
  RunLog log(folder.path + "/run.lcm");
  for (const std::int64_t utime : {10, 20, 30, 25, 40}) {  // a stamp steps back
    log.say("ODOMETRY", utime);
    log.say("LASER", utime);
    log.say("POSE", utime);
  }
  const Resumption resumption{{"LASER", "ODOMETRY"}, "LASER", 30, log.at_us};
  const Missed missed = read_missed(log.path, resumption, "walker", 7, 1000, [&] {
    log.word(7);
    log.say("LASER", 50);  // comes over the network too
  });
  REQUIRE(missed.to_the_end);
  REQUIRE(utimes(missed, "LASER") == std::vector<std::int64_t>{25, 40});
  REQUIRE(utimes(missed, "ODOMETRY") == std::vector<std::int64_t>{10, 20, 30, 25, 40});  // sources are needed from before
  REQUIRE(utimes(missed, "POSE").empty());
}

TEST_CASE("a word of an earlier life with another pid is not taken for ours, and patience ends") {
  const test::TemporaryFolder folder;
  RunLog log(folder.path + "/run.lcm");
  log.say("LASER", 10);
  log.say("LASER", 20);
  log.word(6);
  const Missed missed = read_missed(log.path, {{"LASER"}, "LASER", 10, log.at_us}, "walker", 7, 50, [] {});
  REQUIRE_FALSE(missed.to_the_end);
  REQUIRE(utimes(missed, "LASER") == std::vector<std::int64_t>{20});
}

TEST_CASE("without a run's log nothing was missed that can be found") {
  const test::TemporaryFolder folder;
  const Missed missed = read_missed(folder.path + "/none.lcm", {{"LASER"}, "LASER", 10, 0}, "walker", 7, 20, [] {});
  REQUIRE(missed.events.empty());
  REQUIRE_FALSE(missed.to_the_end);
}

TEST_CASE("a message that was delivered from the log is dropped when it comes over the network after all, once") {
  Transport transport("memq://");
  Bus bus(transport, "walker");
  std::vector<std::int64_t> heard;
  bus.subscribe<bot_core::pose_t>("LASER", [&](const bot_core::pose_t& m) { heard.push_back(m.utime); });
  bot_core::pose_t message{};
  message.utime = 5;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  bus.deliver("LASER", bytes.data(), static_cast<int>(bytes.size()));
  REQUIRE(heard == std::vector<std::int64_t>{5});
  REQUIRE(bus.inputs().at("LASER").received == 0);  // not over the network yet
  for (int k = 0; k < 2; ++k) transport.publish("LASER", bytes.data(), static_cast<int>(bytes.size()));
  while (transport.poll(0)) {
  }
  REQUIRE(heard == std::vector<std::int64_t>{5, 5});
  REQUIRE(bus.inputs().at("LASER").received == 2);
}
