// SPDX-License-Identifier: BSD-3-Clause
/// Finished grid maps: read from files, annotated, written as GeoJSON and SVG.
#include "common/semantics/map_annotator.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/evaluation/semantic_map.hpp"
#include "common/formats/grid_map.hpp"
#include "common/semantics/semantic_files.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace modslam;

namespace {

/// 12 x 8 m at 0.05 m: two rooms of 5 x 6 m with a wall of 0.2 m and a door of 0.9 m between.
MapImage two_rooms_map() {
  MapImage map;
  map.width = 240;
  map.height = 160;
  map.resolution_m = 0.05;
  map.origin_m = {-3, 2};
  cv::Mat1b cells(map.height, map.width, std::uint8_t{0});
  cells(cv::Rect(18, 18, 208, 124)).setTo(255);
  cells(cv::Rect(20, 20, 100, 120)).setTo(1);
  cells(cv::Rect(124, 20, 100, 120)).setTo(1);
  cells(cv::Rect(120, 60, 4, 18)).setTo(1);
  map.cells.assign(cells.begin(), cells.end());
  return map;
}

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

}  // namespace

TEST_CASE("a drawn map of two rooms has two rooms, the door between them and walls on their faces") {
  const SemanticLayers layers = annotate(two_rooms_map(), {}).layers;
  REQUIRE(layers.rooms.size() == 2);
  for (const Room& room : layers.rooms) REQUIRE(room.area_m2 == Approx(30).epsilon(0.03));
  REQUIRE(layers.doors.size() == 1);
  REQUIRE((layers.doors[0].centre() - Eigen::Vector2d(3.1, 5.45)).norm() < 0.15);
  REQUIRE(layers.doors[0].room_a + layers.doors[0].room_b == 3);
  double wall_m = 0;
  for (const Wall& wall : layers.walls) wall_m += wall.length_m();
  REQUIRE(wall_m == Approx(2 * 22 - 2 * 0.9).epsilon(0.1));
  REQUIRE(layers.objects.empty());
}

TEST_CASE("a map is finished when its floor does not lie open to the unexplored, whatever stands on it") {
  const MapImage drawn = two_rooms_map();
  const auto painted = [&](const cv::Rect& box, std::uint8_t value) {
    MapImage map = drawn;
    cv::Mat1b(map.height, map.width, map.cells.data())(box).setTo(value);
    return KnownSpace(map, 0.05);
  };
  CHECK(open_rim(KnownSpace(drawn, 0.05)) == 0);
  CHECK(kind_of(KnownSpace(drawn, 0.05)) == OpeningModel::Kind::kFinished);
  CHECK(kind_of(painted({50, 50, 20, 15}, 0)) == OpeningModel::Kind::kFinished);  // furniture, drawn as unknown
  const KnownSpace halved = painted({180, 0, 60, 160}, 0);                        // nobody saw the right end of the room
  CHECK(open_rim(halved) == Approx(120.0 / (2 * (100 + 55) + 2 * 120 + 120 + 102)).epsilon(0.1));
  CHECK(kind_of(halved) == OpeningModel::Kind::kSensed);
  CHECK(open_rim(KnownSpace(0.05)) == 0);
}

TEST_CASE("an empty map, one wall and a map of noise are annotated without a crash") {
  REQUIRE(annotate({}, {}).layers.rooms.empty());
  MapImage map = two_rooms_map();
  std::fill(map.cells.begin(), map.cells.end(), std::uint8_t{0});
  REQUIRE(annotate(map, {}).layers.walls.empty());
  std::fill(map.cells.begin() + 240 * 80 + 40, map.cells.begin() + 240 * 80 + 200, std::uint8_t{255});
  REQUIRE(annotate(map, {}).layers.rooms.empty());
  std::uint32_t state = 12345;
  for (std::uint8_t& cell : map.cells) {
    state = state * 1664525u + 1013904223u;
    cell = state >> 31 ? 255 : 1;
  }
  REQUIRE(annotate(map, {}).layers.rooms.empty());
}

TEST_CASE("the GeoJSON of an annotated map is read back by the scorer; the SVG has a line for each wall") {
  const SemanticLayers layers = annotate(two_rooms_map(), {}).layers;
  const SemanticMap read = parse_semantic_map(semantic_geojson(layers));
  REQUIRE(read.walls.size() == layers.walls.size());
  REQUIRE(read.rooms.size() == 2);
  REQUIRE(read.doors.size() == 1);
  REQUIRE(read.doors[0].rooms_known);
  const std::string svg = semantic_svg(layers);
  std::size_t lines = 0;
  for (std::size_t at = svg.find("<line"); at != std::string::npos; at = svg.find("<line", at + 1)) ++lines;
  REQUIRE(lines == layers.walls.size() + layers.doors.size());
  REQUIRE_FALSE(semantic_svg({}).empty());
  SemanticLayers broken;
  broken.walls.resize(1);
  broken.walls[0].a = {NAN, 0};
  broken.walls[0].b = {1, INFINITY};
  REQUIRE(nlohmann::json::parse(semantic_geojson(broken))["features"].size() == 1);
  REQUIRE(semantic_svg(broken).find("nan") == std::string::npos);
}

TEST_CASE("a map_server YAML with its picture is read: row 0 lowest, thresholds and negate kept") {
  const test::TemporaryFolder folder;
  const std::string base = folder.path + "/";
  cv::Mat1b picture(2, 3, std::uint8_t{254});
  picture(0, 0) = 0;    // upper left occupied
  picture(1, 2) = 205;  // lower right unknown
  cv::imwrite(base + "map.png", picture);
  write(base + "map.yaml", "image: map.pgm  # only the .png is there\nresolution: 0.1\norigin: [1.5, -2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
  const MapImage map = read_grid_map(base + "map.yaml");
  REQUIRE(map.width == 3);
  REQUIRE(map.height == 2);
  REQUIRE(map.origin_m == Eigen::Vector2d(1.5, -2));
  REQUIRE(map.cells == std::vector<std::uint8_t>{1, 1, 0, 255, 1, 1});
  const auto refused = [&](const std::string& yaml, const std::string& words) {
    write(base + "bad.yaml", yaml);
    REQUIRE_THROWS_WITH(read_grid_map(base + "bad.yaml"), Catch::Contains(words) && Catch::Contains("bad.yaml"));
  };
  refused("resolution: 0.1\norigin: [0, 0, 0]\n", "image");
  refused("image: map.png\nresolution: fine\norigin: [0, 0, 0]\n", "resolution: 'fine'");
  refused("image: map.png\nresolution: 0\norigin: [0, 0, 0]\n", "0.001 to 10");
  refused("image: map.png\nresolution: 0.1\norigin: [0, 0, 0.5]\n", "turned");
  refused("image: map.png\nresolution: 0.1\norigin: [0]\n", "origin");
  refused("image: gone.png\nresolution: 0.1\norigin: [0, 0, 0]\n", "gone.png");
  REQUIRE_THROWS_WITH(read_grid_map(base + "none.yaml"), Catch::Contains("cannot be read"));
}
