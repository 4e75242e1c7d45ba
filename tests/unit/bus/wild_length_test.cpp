// SPDX-License-Identifier: BSD-3-Clause
#include <catch2/catch.hpp>
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
