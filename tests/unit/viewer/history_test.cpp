// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/history.hpp"

#include <catch2/catch.hpp>
#include <random>

namespace modslam {
namespace {

FramePtr frame(const std::string& words) { return std::make_shared<Frame>(Frame{false, words}); }

std::vector<std::string> words_at(const History& history, double seconds) {
  std::vector<std::string> words;
  for (const FramePtr& f : history.at(static_cast<std::int64_t>(seconds * 1e6)))
    words.push_back(f->bytes);
  return words;
}

constexpr std::int64_t s(double seconds) { return static_cast<std::int64_t>(seconds * 1e6); }

TEST_CASE("the past shows of each stream what was newest then, and nothing of later ones") {
  History history(1 << 20);
  history.add("rooms", s(10), frame("one room"));
  history.add("pose", s(10.5), frame("here"));
  history.add("rooms", s(20), frame("two rooms"));
  CHECK(words_at(history, 9).empty());
  CHECK(words_at(history, 10.2) == std::vector<std::string>{"one room"});
  CHECK(words_at(history, 19.9) == std::vector<std::string>{"here", "one room"});
  CHECK(words_at(history, 1e6) == std::vector<std::string>{"here", "two rooms"});
  CHECK(history.extent().begin_utime == s(10));
  CHECK(history.extent().end_utime == s(20));
}

TEST_CASE("within an interval only the newest frame is kept") {
  History history(1 << 20);
  for (int i = 0; i < 10; ++i) history.add("pose", s(1) + i * 10'000, frame(std::to_string(i)));
  CHECK(words_at(history, 2) == std::vector<std::string>{"9"});
  CHECK(history.extent().bytes < 200);
}

TEST_CASE("a stamp that steps back counts as the newest one") {
  History history(1 << 20);
  history.add("pose", s(10), frame("first"));
  history.add("pose", s(4), frame("second"));
  CHECK(words_at(history, 10) == std::vector<std::string>{"second"});
  CHECK(history.extent().begin_utime == s(10));
}

TEST_CASE("a long run stays within its budget, whole, in larger steps, and its end is exact") {
  History history(40'000);
  std::mt19937 random(7);
  std::string newest[3];
  for (int i = 1; i <= 20'000; ++i) {
    const auto stream = random() % 3;
    newest[stream] = std::to_string(i) + std::string(random() % 60, 'x');
    history.add("stream " + std::to_string(stream), s(0.1 * i), frame(newest[stream]));
    REQUIRE(history.extent().bytes <= 40'000);
  }
  const History::Extent extent = history.extent();
  CHECK(extent.begin_utime == s(0.1));
  CHECK(extent.interval_us > 10 * History::kFirstInterval_us);
  CHECK(words_at(history, 2000) == std::vector<std::string>(newest, newest + 3));
  // Half way: what is shown is at most one interval old, and never of the future.
  for (const std::string& words : words_at(history, 1000)) {
    const double told_s = 0.1 * std::stoi(words);
    CHECK(told_s <= 1000);
    CHECK(told_s >= 1000 - 2 * static_cast<double>(extent.interval_us) * 1e-6);
  }
}

TEST_CASE("a tile comes back as it was, and what is larger than all memory for the past is left out") {
  History history(1000);
  const std::string tile("\0\1binary\xff", 9);
  history.add("tile", s(1), std::make_shared<Frame>(Frame{true, tile}));
  history.add("huge", s(2), std::make_shared<Frame>(Frame{true, std::string(1000, 'x')}));
  const auto frames = history.at(s(3));
  REQUIRE(frames.size() == 1);
  CHECK(frames[0]->binary);
  CHECK(frames[0]->bytes == tile);
  CHECK(history.extent().bytes < 100);
  History none(0);
  none.add("pose", s(1), frame("here"));
  CHECK(none.at(s(2)).empty());
}

TEST_CASE("another session begins with an empty past") {
  History history(1 << 20);
  history.add("pose", s(100), frame("old"));
  history.clear();
  history.add("pose", s(5), frame("new"));
  CHECK(history.extent().begin_utime == s(5));
  CHECK(words_at(history, 200) == std::vector<std::string>{"new"});
}

}  // namespace
}  // namespace modslam
