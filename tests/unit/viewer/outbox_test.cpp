// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/outbox.hpp"

#include <catch2/catch.hpp>
#include <random>
#include <thread>

#include "viewer/hub.hpp"

namespace modslam {
namespace {

using std::chrono::milliseconds;

FramePtr frame(const std::string& text) { return std::make_shared<Frame>(Frame{false, text}); }

std::string take(Outbox& outbox) {
  const auto taken = outbox.take(milliseconds(0));
  return taken ? (*taken)->bytes : "nothing";
}

TEST_CASE(
    "an outbox hands out streams in the order in which they began to wait, each with its newest "
    "frame") {
  Outbox outbox;
  outbox.put("scan", frame("scan 1"));
  outbox.put("walls", frame("walls 1"));
  outbox.put("scan", frame("scan 2"));
  CHECK(outbox.size() == 2);
  CHECK(take(outbox) == "scan 2");
  CHECK(take(outbox) == "walls 1");
  CHECK(take(outbox) == "nothing");
}

TEST_CASE("an outbox that nobody empties never holds more than one frame a stream") {
  Outbox outbox;
  std::mt19937_64 random(7);
  std::vector<std::string> newest(20);
  for (int i = 0; i < 100'000; ++i) {
    const std::size_t stream = random() % newest.size();
    newest[stream] = std::to_string(i);
    outbox.put("stream " + std::to_string(stream), frame(newest[stream]));
    REQUIRE(outbox.size() <= newest.size());
  }
  std::multiset<std::string> wanted(newest.begin(), newest.end()), got;
  while (outbox.size() > 0) got.insert(take(outbox));
  CHECK(got == wanted);
}

TEST_CASE("a fast stream does not starve a slow one") {
  Outbox outbox;
  outbox.put("fast", frame("fast 0"));
  outbox.put("slow", frame("slow"));
  std::vector<std::string> sent;
  for (int i = 1; i <= 4; ++i) {
    outbox.put("fast", frame("fast " + std::to_string(i)));
    sent.push_back(take(outbox));
  }
  CHECK(sent == std::vector<std::string>{"fast 1", "slow", "fast 3", "fast 4"});
}

TEST_CASE("closing an outbox wakes who waits for it, and what comes later is dropped") {
  Outbox outbox;
  std::thread waiter([&] { CHECK(!outbox.take(milliseconds(20'000))); });
  outbox.close();
  waiter.join();
  outbox.put("scan", frame("late"));
  CHECK(outbox.size() == 0);
}

TEST_CASE(
    "a page that joins late gets a hello and the newest of every stream; one that left gets "
    "nothing") {
  Hub hub(frame("hello"));
  const auto early = hub.join();
  hub.publish("pose", frame("pose 1"));
  hub.publish("pose", frame("pose 2"));
  hub.publish("status/laser", frame("well"));
  hub.leave(early);
  const auto late = hub.join();
  CHECK(hub.pages() == 1);
  CHECK(take(*late) == "hello");
  CHECK(take(*late) == "pose 2");
  CHECK(take(*late) == "well");
  CHECK(take(*early) == "nothing");
}

TEST_CASE("a restart makes every page forget all but what is kept, whatever still waited") {
  Hub hub(frame("hello"));
  const auto page = hub.join();
  hub.publish("nodes/0", frame("old nodes"));
  hub.publish("status/laser", frame("well"));
  hub.restart("status/");
  CHECK(take(*page) == "hello");
  CHECK(take(*page) == "well");
  CHECK(take(*page) == "nothing");
  CHECK(hub.streams() == 1);
}

}  // namespace
}  // namespace modslam
