// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/loss_meter.hpp"

#include <bot_core/pose_t.hpp>
#include <catch2/catch.hpp>

using namespace modslam;

namespace {

process_status_t sender(std::int32_t pid, std::int64_t sent, const std::string& channel = "LASER") {
  channel_count_t out{};
  out.channel = channel;
  out.received = sent;
  process_status_t status{};
  status.name = "laser";
  status.pid = pid;
  status.outputs = {out};
  status.noutputs = 1;
  return status;
}

struct Listener {
  Listener() { bus.subscribe<bot_core::pose_t>("LASER", [](const bot_core::pose_t&) {}); }
  void hear(int count) {
    for (int k = 0; k < count; ++k) {
      bot_core::pose_t message{};
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      transport.publish("LASER", bytes.data(), static_cast<int>(bytes.size()));
    }
    while (transport.poll(0)) {
    }
  }
  std::int64_t lost() const { return bus.inputs().at("LASER").lost; }
  Transport transport{"memq://"};
  Bus bus{transport, "listener"};
  LossMeter meter;
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(static_cast<std::size_t>(bot_core::pose_t().getEncodedSize()));
};

}  // namespace

TEST_CASE("losses are what the sender counted more than came, since both know each other") {
  Listener listener;
  listener.hear(3);
  REQUIRE(listener.meter.take(sender(1, 100), listener.bus).empty());  // what was before is nobody's loss
  listener.hear(8);
  REQUIRE(listener.meter.take(sender(1, 110), listener.bus) == std::vector<std::string>{"LASER"});
  REQUIRE(listener.lost() == 2);
  listener.hear(10);
  REQUIRE(listener.meter.take(sender(1, 120), listener.bus).empty());
  REQUIRE(listener.lost() == 2);
}

TEST_CASE("a sender that was started again counts anew, and what was lost before stays counted") {
  Listener listener;
  listener.meter.take(sender(1, 0), listener.bus);
  listener.hear(7);
  listener.meter.take(sender(1, 10), listener.bus);
  REQUIRE(listener.lost() == 3);
  REQUIRE(listener.meter.take(sender(2, 1), listener.bus).empty());
  listener.hear(4);
  listener.meter.take(sender(2, 6), listener.bus);
  REQUIRE(listener.lost() == 4);
}

TEST_CASE("a STATUS that was lost is counted for its own sender") {
  Listener listener;
  listener.bus.subscribe<process_status_t>("STATUS", [](const process_status_t&) {});
  process_status_t other = sender(9, 100, "STATUS");
  other.name = "odometry";
  for (const std::int64_t said_before : {0, 1, 2, 5, 6}) {  // two are missing
    listener.meter.take(sender(1, said_before, "STATUS"), listener.bus);
    ++other.outputs[0].received;
    listener.meter.take(other, listener.bus);
  }
  REQUIRE(listener.bus.inputs().at("STATUS").lost == 2);
}

TEST_CASE("channels that nobody here listens to, or that many speak on, are not counted") {
  Listener listener;
  listener.bus.subscribe<process_status_t>("COMMAND", [](const process_status_t&) {});
  for (const char* channel : {"COMMAND", "ELSEWHERE"}) {
    listener.meter.take(sender(1, 0, channel), listener.bus);
    REQUIRE(listener.meter.take(sender(1, 10, channel), listener.bus).empty());
  }
  REQUIRE(listener.bus.inputs().count("ELSEWHERE") == 0);
}

TEST_CASE("of a sender that was heard before it said anything on a channel, the first messages count as lost although the STATUS that told of them was") {
  Listener listener;
  for (std::int64_t k = 1; k <= 3; ++k) listener.meter.take(sender(1, k, "STATUS"), listener.bus);
  listener.hear(8);  // of ten; what he said of them is lost too
  listener.hear(19);
  REQUIRE(listener.meter.take(sender(1, 30), listener.bus) == std::vector<std::string>{"LASER"});
  REQUIRE(listener.lost() == 3);
}
