// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/repeats.hpp"

#include <algorithm>
#include <bot_core/pose_t.hpp>
#include <catch2/catch.hpp>
#include <limits>
#include <modslam/scan_match_t.hpp>
#include <utility>

using namespace modslam;

namespace {

constexpr std::int64_t kStep_us = 50'000;

std::vector<std::uint8_t> message(std::int64_t utime) {
  bot_core::pose_t pose{};
  pose.utime = utime;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(pose.getEncodedSize()));
  pose.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// A speaker on ODOMETRY and a listener; what the network loses is simply not handed over.
struct Pair {
  Pair() {
    bus.subscribe<bot_core::pose_t>("ODOMETRY", [this](const bot_core::pose_t& m) { heard.push_back(m.utime / kStep_us); });
    channel_count_t out{};
    out.channel = "ODOMETRY";
    process_status_t status{};
    status.outputs = {out};
    status.noutputs = 1;
    repair.take(status);
  }
  void say(std::int64_t step, bool arrives = true) {
    const std::vector<std::uint8_t> bytes = message(step * kStep_us);
    kept.keep("ODOMETRY", bytes.data(), static_cast<int>(bytes.size()));
    if (arrives) hear(step);
  }
  void hear(std::int64_t step) {
    const std::vector<std::uint8_t> bytes = message(step * kStep_us);
    transport.publish("ODOMETRY", bytes.data(), static_cast<int>(bytes.size()));
    while (transport.poll(0)) {
    }
  }
  /// Lets the speaker answer what was asked, but for every `lost`th answer.
  void answer(std::int64_t lost = 1'000'000) {
    const std::vector<repeat_request_t> questions = std::move(asked);
    asked.clear();
    for (const repeat_request_t& question : questions)
      for (const repeat_t& one : kept.answer(question, now_us))
        if (++answers % lost != 0) repair.take(one);
  }
  void wait(std::int64_t us) {
    for (const std::int64_t end = now_us + us; now_us < end;) repair.tick(now_us += 5'000);
  }
  std::int64_t received() const { return bus.inputs().at("ODOMETRY").received; }

  Transport transport{"memq://"};
  Bus bus{transport, "listener"};
  std::vector<repeat_request_t> asked;
  StreamRepair repair{bus, [this](const repeat_request_t& m) { asked.push_back(m); }};
  KeptMessages kept;
  std::vector<std::int64_t> heard;
  std::int64_t now_us = 1, answers = 0;
};

std::vector<std::int64_t> up_to(std::int64_t last) {
  std::vector<std::int64_t> all;
  for (std::int64_t k = 1; k <= last; ++k) all.push_back(k);
  return all;
}

}  // namespace

TEST_CASE("a stream without a gap passes at once, and after the first few messages nobody asks anything") {
  Pair pair;
  for (std::int64_t k = 1; k <= 5; ++k) pair.say(k), pair.answer();
  for (std::int64_t k = 6; k <= 40; ++k) {
    pair.say(k);
    REQUIRE(pair.asked.empty());
    REQUIRE(pair.heard.back() == k);
  }
  REQUIRE(pair.heard == up_to(40));
}

TEST_CASE("what was lost is repeated and all is handled in order; the loss stays countable") {
  Pair pair;
  for (std::int64_t k = 1; k <= 30; ++k) pair.say(k, k < 10 || k % 3 != 0), pair.answer();
  REQUIRE(pair.heard == up_to(29));
  REQUIRE(pair.received() == 23);  // over the network itself
  pair.repair.suspect("ODOMETRY");
  REQUIRE(pair.bus.awaits("ODOMETRY"));
  pair.answer();
  REQUIRE(pair.heard == up_to(30));  // the last one, that no later one told of
  REQUIRE_FALSE(pair.bus.awaits("ODOMETRY"));
}

TEST_CASE("a long gap is asked for once and again for what the answer left out, not after every message of it") {
  Pair pair;
  for (std::int64_t k = 1; k <= 10; ++k) pair.say(k), pair.answer();
  for (std::int64_t k = 11; k <= 400; ++k) pair.say(k, false);
  pair.say(401);
  std::size_t questions = 0;
  for (int k = 0; k < 40; ++k) {
    questions += pair.asked.size();
    pair.answer(), pair.wait(10'000);
  }
  REQUIRE(pair.heard == up_to(401));
  REQUIRE(questions <= 6);
  REQUIRE(pair.answers < 450);
}

TEST_CASE("what waits behind a gap is not overtaken when a question about the newest stays without an answer") {
  Pair pair;
  for (std::int64_t k = 1; k <= 10; ++k) pair.say(k), pair.answer();
  pair.repair.suspect("ODOMETRY");
  pair.asked.clear();
  pair.wait(900'000);
  pair.hear(13), pair.hear(14);
  pair.wait(300'000);
  pair.hear(30), pair.hear(31);
  pair.wait(2'000'000);
  REQUIRE(std::is_sorted(pair.heard.begin(), pair.heard.end()));
  REQUIRE(pair.heard.back() == 31);
}

TEST_CASE("a second without any answer to a question about the newest does not end the repair: all that was said in it is asked for") {
  Pair pair;
  for (std::int64_t k = 1; k <= 10; ++k) pair.say(k), pair.answer();
  pair.say(11, false);
  pair.repair.suspect("ODOMETRY");  // a STATUS told of one more; then the cable is cut
  for (std::int64_t k = 12; k <= 33; ++k) pair.say(k, false), pair.wait(kStep_us);
  pair.asked.clear();
  REQUIRE_FALSE(pair.bus.awaits("ODOMETRY"));
  pair.say(34);
  for (int k = 0; k < 5; ++k) pair.answer(), pair.wait(20'000);
  REQUIRE(pair.heard == up_to(34));
  REQUIRE(pair.bus.inputs().at("ODOMETRY").gaps == 0);
}

TEST_CASE("a speaker that does not answer is asked about its newest once, and again when it was heard") {
  Pair pair;
  for (std::int64_t k = 1; k <= 10; ++k) pair.say(k), pair.answer();
  pair.repair.suspect("ODOMETRY");
  pair.wait(1'100'000);
  pair.asked.clear();
  pair.repair.suspect("ODOMETRY");  // nobody is made to wait for the dead again and again
  REQUIRE_FALSE(pair.bus.awaits("ODOMETRY"));
  REQUIRE(pair.asked.empty());
  pair.say(11), pair.say(12, false);
  pair.repair.suspect("ODOMETRY");
  REQUIRE(pair.bus.awaits("ODOMETRY"));
  pair.answer();
  REQUIRE(pair.heard == up_to(12));
}

TEST_CASE("answers that get lost too are asked for again, also after a second without any") {
  Pair pair;
  for (std::int64_t k = 1; k <= 200; ++k) {
    pair.say(k, k < 10 || (k > 30 && k % 7 != 0));
    pair.answer(5);
    pair.wait(kStep_us);
  }
  for (int k = 0; k < 20; ++k) pair.wait(kStep_us), pair.answer(5);
  REQUIRE(pair.heard == up_to(200));
}

TEST_CASE("when nobody has a copy what came behind the gap is held back for a second, no longer") {
  Pair pair;
  for (std::int64_t k = 1; k <= 10; ++k) pair.say(k), pair.answer();
  pair.hear(13);
  pair.hear(14);
  REQUIRE(pair.heard.back() == 10);
  pair.wait(900'000);
  REQUIRE(pair.heard.back() == 10);
  REQUIRE(pair.asked.size() > 10);
  pair.wait(200'000);
  REQUIRE(pair.heard.back() == 14);
  REQUIRE(pair.bus.inputs().at("ODOMETRY").gaps == 1);
  REQUIRE(pair.repair.idle());
}

TEST_CASE("messages that the network doubles or reorders are handled once and in order, and are counted once") {
  Pair pair;
  for (std::int64_t k = 1; k <= 10; ++k) pair.say(k), pair.answer();
  pair.say(11, false), pair.say(12, false), pair.say(13, false);
  for (const std::int64_t k : {13, 12, 12, 11, 13, 11}) pair.hear(k);
  REQUIRE(pair.heard == up_to(13));
  REQUIRE(pair.received() == 13);
}

TEST_CASE("a pause of the speaker is no loss: one question tells") {
  Pair pair;
  for (std::int64_t k = 1; k <= 10; ++k) pair.say(k), pair.answer();
  pair.say(60);
  REQUIRE(pair.asked.size() == 1);
  pair.answer();
  REQUIRE(pair.heard.back() == 60);
}

TEST_CASE("without a speaker that keeps copies nothing is held back or asked for, and stamps may step back") {
  Pair pair;
  pair.repair.~StreamRepair();
  new (&pair.repair) StreamRepair(pair.bus, [&](const repeat_request_t& m) { pair.asked.push_back(m); });
  for (const std::int64_t k : {1, 2, 9, 4, 4, 30}) pair.hear(k);
  REQUIRE(pair.heard == std::vector<std::int64_t>{1, 2, 9, 4, 4, 30});
  REQUIRE(pair.asked.empty());
}

TEST_CASE("a stream whose times step back again and again is passed on as it comes, though its speaker keeps copies") {
  Pair pair;
  std::vector<std::int64_t> said;
  const auto say = [&](std::int64_t step) {
    said.push_back(step);
    pair.say(step);
  };
  for (std::int64_t k = 1; k <= 400; ++k) {
    say(k + (k / 10 % 2 ? 20 : 0));  // twenty steps forth, ten steps later back, and so on
    if (k > 30) REQUIRE(pair.heard == said);
    pair.answer();
  }
}

TEST_CASE("matches are put in order by their numbers, whatever their times, also when a matcher without a memory begins again at 0") {
  Transport transport("memq://");
  Bus bus(transport, "listener");
  std::vector<repeat_request_t> asked;
  StreamRepair repair(bus, [&](const repeat_request_t& m) { asked.push_back(m); });
  std::vector<std::int64_t> heard;
  bus.subscribe<scan_match_t>("SCAN_MATCH", [&](const scan_match_t& m) { heard.push_back(m.seq); });
  process_status_t status{};
  status.outputs.resize(status.noutputs = 1);
  status.outputs[0].channel = "SCAN_MATCH";
  repair.take(status);
  KeptMessages kept;
  const auto say = [&](std::int64_t track, std::int64_t seq, bool arrives) {
    scan_match_t match{};
    match.utime = 1'000'000'000 + 200'000 * track - (seq % 7) * 90'000;
    match.track = track;
    match.seq = seq;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(match.getEncodedSize()));
    match.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    kept.keep("SCAN_MATCH", bytes.data(), static_cast<int>(bytes.size()));
    if (arrives) transport.publish("SCAN_MATCH", bytes.data(), static_cast<int>(bytes.size()));
    while (transport.poll(0)) {
    }
    for (const repeat_request_t& question : std::exchange(asked, {}))
      for (const repeat_t& one : kept.answer(question, 1)) repair.take(one);
  };
  std::vector<std::int64_t> said;
  for (std::int64_t track = 0; track < 2; ++track)
    for (std::int64_t seq = 0; seq < 40; ++seq) {
      say(track, seq, seq % 5 != 3);
      said.push_back(seq);
    }
  REQUIRE(heard == said);
}

TEST_CASE("the same question of several listeners is answered once") {
  KeptMessages kept;
  for (std::int64_t k = 1; k <= 5; ++k) {
    const std::vector<std::uint8_t> bytes = message(k * kStep_us);
    kept.keep("ODOMETRY", bytes.data(), static_cast<int>(bytes.size()));
  }
  repeat_request_t question{};
  question.channel = "ODOMETRY";
  question.after = kStep_us;
  question.before = 4 * kStep_us;
  REQUIRE(kept.answer(question, 1'000'000).size() == 3);  // two messages, and that the third of them stands before the fourth
  REQUIRE(kept.answer(question, 1'001'000).empty());
  REQUIRE(kept.answer(question, 1'100'000).size() == 3);
  question.channel = "LASER";
  REQUIRE(kept.answer(question, 1'100'000).empty());
}
