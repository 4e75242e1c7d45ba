// SPDX-License-Identifier: BSD-3-Clause
#include "common/maps/mosaic.hpp"

#include <catch2/catch.hpp>

using namespace modslam;

TEST_CASE("tiles join where they belong and the picture is cropped to what is known") {
  MapTile left{-1, 0, 4, 0.5, std::vector<std::uint8_t>(16)},
      right{0, 0, 4, 0.5, std::vector<std::uint8_t>(16)};
  left.cells[1 * 4 + 3] = 200;  // column -1, row 1
  right.cells[2 * 4 + 1] = 9;   // column  1, row 2
  const MapImage image = join_tiles({left, right}, 1);
  REQUIRE(image.width == 5);   // columns -2 .. 2
  REQUIRE(image.height == 4);  // rows 0 .. 3
  REQUIRE(image.origin_m.x() == -1.0);
  REQUIRE(image.origin_m.y() == 0.0);
  REQUIRE(image.at(1, 1) == 200);
  REQUIRE(image.at(3, 2) == 9);
  REQUIRE(std::count(image.cells.begin(), image.cells.end(), 0) == 18);
}

TEST_CASE("no tile, or none with a known cell, is an empty picture") {
  REQUIRE(join_tiles({}, 3).empty());
  REQUIRE(join_tiles({{5, 5, 4, 0.1, std::vector<std::uint8_t>(16)}}, 3).empty());
}

TEST_CASE("tiles that no picture can hold are refused in words") {
  MapTile here{0, 0, 4, 0.1, std::vector<std::uint8_t>(16, 1)}, far = here, other = here;
  far.x = far.y = 1000000;
  other.resolution_m = 0.2;
  REQUIRE_THROWS_WITH(join_tiles({here, far}, 0), Catch::Contains("cells"));
  REQUIRE_THROWS_WITH(join_tiles({here, other}, 0), Catch::Contains("resolutions"));
}

TEST_CASE("packed cells come back, and what is no pack of cells is refused") {
  std::vector<std::uint8_t> cells(64 * 64);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = static_cast<std::uint8_t>(i * i / 7);
  std::vector<std::uint8_t> packed = pack_cells(cells);
  REQUIRE(unpack_cells(packed.data(), packed.size(), 64) == cells);
  REQUIRE_THROWS(unpack_cells(packed.data(), packed.size(), 63));
  REQUIRE_THROWS(unpack_cells(packed.data(), packed.size() / 2, 64));
  REQUIRE_THROWS(unpack_cells(packed.data(), packed.size(), -1));
  REQUIRE_THROWS(unpack_cells(nullptr, 0, 64));
}
