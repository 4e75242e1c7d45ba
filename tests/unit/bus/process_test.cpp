// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/process.hpp"

#include <modslam/process_status_t.hpp>

#include "common/bus/channels.hpp"
#include "tests/support/stage.hpp"
#include <catch2/catch.hpp>

using namespace modslam;

TEST_CASE("preflight has nothing to say about buses that need no multicast") {
  REQUIRE(preflight("memq://").empty());
  REQUIRE(preflight("file:///tmp/x.lcm").empty());
}

TEST_CASE("preflight says at once whether multicast comes back, and if not what to type") {
  const std::string trouble = preflight("udpm://239.255.76.67:27913?ttl=0");
  if (!trouble.empty()) REQUIRE_THAT(trouble, Catch::Matchers::Contains("multicast"));
}

namespace {
struct Talker : Module {
  std::string words() const override { return "all is well"; }
};
}  // namespace

TEST_CASE("a status counts what came in and went out, and a reproducible one holds nothing of the machine") {
  test::Stage stage;
  Bus& bus = stage.bus("talker");
  bus.subscribe<process_status_t>("IN", [](const process_status_t&) { throw BadMessage("never"); });
  auto& statuses = stage.record<process_status_t>(channel::kStatus);
  Talker module;
  StatusReporter reporter(bus, module);
  bus.publish("IN", process_status_t{});
  stage.transport.publish("IN", "garbage", 7);
  stage.drain();
  reporter.add_latency(300);
  reporter.publish(process_status_t::RUNNING, true);
  reporter.publish(process_status_t::FINISHED, false);
  stage.drain();
  REQUIRE(statuses.size() == 2);
  const process_status_t& measured = statuses[0];
  REQUIRE(measured.words == "all is well");
  REQUIRE(measured.ninputs == 1);
  REQUIRE(measured.inputs[0].received == 2);
  REQUIRE(measured.inputs[0].bad == 2);
  REQUIRE(measured.pid > 0);
  REQUIRE(measured.memory_kb > 0);
  REQUIRE(statuses[1].pid == 0);
  REQUIRE(statuses[1].memory_kb == 0);
}
