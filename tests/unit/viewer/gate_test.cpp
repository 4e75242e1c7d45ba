// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gate.hpp"

#include <catch2/catch.hpp>

namespace modslam {
namespace {

TEST_CASE("without a token only this machine's own page is let in") {
  const Gate gate("127.0.0.1", "");
  CHECK(gate.admits("127.0.0.1:8080", "http://127.0.0.1:8080", ""));
  CHECK(gate.admits("localhost:8080", "", ""));
  CHECK_FALSE(gate.admits("127.0.0.1:8080", "http://evil.example", ""));
  CHECK_FALSE(gate.admits("evil.example:8080", "http://evil.example:8080", ""));
  CHECK_FALSE(gate.open_to_others());
}

TEST_CASE("opened wider, a page needs the token and must come from this server") {
  const std::string token = "0123456789abcdef";
  const Gate gate("0.0.0.0", token);
  CHECK(gate.open_to_others());
  CHECK(gate.admits("robot:8080", "http://robot:8080", "token=" + token));
  CHECK(gate.admits("robot:8080", "", "utime=5&token=" + token));
  CHECK_FALSE(gate.admits("robot:8080", "http://evil.example", "token=" + token));
  for (const char* query : {"", "token=", "token=0123456789abcdeF", "token=0123456789abcdef0",
                            "token=0123456789abcde", "nottoken=0123456789abcdef"})
    CHECK_FALSE(gate.admits("robot:8080", "http://robot:8080", query));
}

TEST_CASE("opening wider without a secret is refused, in words") {
  CHECK_THROWS_WITH(Gate("0.0.0.0", ""), Catch::Contains("MODSLAM_TOKEN"));
  CHECK_THROWS_WITH(Gate("192.168.1.5", "short"), Catch::Contains("16"));
}

TEST_CASE("a flood of requests is let through at its rate") {
  RateLimit limit(10, 5);
  int passed = 0;
  for (int i = 0; i < 10'000; ++i) passed += limit.take();
  CHECK(passed >= 5);
  CHECK(passed < 20);
}

TEST_CASE("a page may wish for what a player knows, and no more than a few at once") {
  Wishes wishes;
  for (const char* good : {"play", "pause", "step", "speed 0.5", "speed 20"})
    CHECK(wishes.add(good));
  for (const char* bad : {"", "finish", "speed", "speed ", "speed 0", "speed -1", "speed nan",
                          "speed 1e9", "speed 1x", "play\n", "speed 1.00000000000000"})
    CHECK_FALSE(wishes.add(bad));
  CHECK(wishes.take() == std::string("play"));
  for (int i = 0; i < 1000; ++i) wishes.add("step");
  std::size_t left = 0;
  while (wishes.take()) ++left;
  CHECK(left == Wishes::kMost);
}

}  // namespace
}  // namespace modslam
