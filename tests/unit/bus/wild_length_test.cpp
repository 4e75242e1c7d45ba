// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <catch2/catch.hpp>
#include <modslam/answer_t.hpp>
#include <modslam/command_t.hpp>
#include <modslam/graph_update_t.hpp>

using namespace modslam;

TEST_CASE("an array length that wraps an int when multiplied is refused, not believed") {
  graph_update_t update{};
  update.retracted = {7};
  update.nretracted = 1;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(update.getEncodedSize()));
  const int size = static_cast<int>(bytes.size());
  REQUIRE(update.encode(bytes.data(), 0, size) == size);
  // nretracted stands before its one element (8 bytes) and nposes (4 bytes).
  const std::size_t at = bytes.size() - 16;
  REQUIRE(bytes[at + 3] == 1);
  for (const int wild : {0x20, 0x40, 0x7f, 0x80, 0xff}) {  // 0x20000001 * 8 = 8 in 32 bits
    bytes[at] = static_cast<std::uint8_t>(wild);
    REQUIRE(update.decode(bytes.data(), 0, size) < 0);
  }
}

TEST_CASE("a text of length zero or less is refused: LCM reads it as one of two gigabytes") {
  command_t command{};
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(command.getEncodedSize()));
  const int size = static_cast<int>(bytes.size());
  REQUIRE(command.encode(bytes.data(), 0, size) == size);
  const std::size_t at = 16;  // fingerprint, utime, then the length of `target`: 1, its final zero
  REQUIRE(bytes[at + 3] == 1);
  for (const std::uint32_t wild : {0x00000000u, 0x80000000u, 0xffffffffu}) {
    for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<std::uint8_t>(wild >> (24 - 8 * k));
    REQUIRE(command.decode(bytes.data(), 0, size) < 0);
  }
}

TEST_CASE("so is one in an array of texts") {
  answer_t answer{};
  answer.nrooms = 1;
  answer.room = answer.building = {1};
  answer.name = {"hall"};
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(answer.getEncodedSize()));
  const int size = static_cast<int>(bytes.size());
  REQUIRE(answer.encode(bytes.data(), 0, size) == size);
  const std::vector<std::uint8_t> text{0, 0, 0, 5, 'h', 'a', 'l', 'l', 0};
  const auto at = std::search(bytes.begin(), bytes.end(), text.begin(), text.end());
  REQUIRE(at != bytes.end());
  for (const int wild : {0x80, 0xff}) {
    *at = static_cast<std::uint8_t>(wild);
    REQUIRE(answer.decode(bytes.data(), 0, size) < 0);
  }
}
