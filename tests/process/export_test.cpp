// SPDX-License-Identifier: BSD-3-Clause
/// What export writes, read back by the libraries that other programs use.
#include "procs/export/export.hpp"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <map>

#include "common/formats/grid_map.hpp"
#include "common/formats/map_server.hpp"
#include "common/semantics/layers_reader.hpp"
#include "common/semantics/semantic_files.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A room of 4 x 3 m with a wall, a door, an object; in a map of 6 x 5 m whose corner lies at (-1, -1).
SemanticLayers sample_layers() {
  SemanticLayers layers;
  Wall wall;
  wall.id = 7;
  wall.a = {0, 0};
  wall.b = {4, 0};
  layers.walls = {wall};
  Room room;
  room.id = 3;
  room.name = "Room 3 \"big\"";
  room.area_m2 = 12;
  room.explored = 1;
  room.outline = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
  layers.rooms = {room};
  Door door;
  door.id = 5;
  door.a = {4, 1};
  door.b = {4, 2};
  door.room_a = 3;
  door.closed = true;
  layers.doors = {door};
  Object object;
  object.id = 9;
  object.class_name = "table";
  object.outline = {{1, 1}, {2, 1}, {2, 2}};
  layers.objects = {object};
  Place place;
  place.node = 0;
  place.p = {2, 1.5};
  place.kind = PlaceKind::kDoorway;
  place.confidence = 0.75;
  layers.places = {place};
  return layers;
}

MapImage sample_map() {
  MapImage map;
  map.width = 60;
  map.height = 50;
  map.resolution_m = 0.1;
  map.origin_m = {-1, -1};
  map.cells.assign(60 * 50, 1);
  for (int column = 10; column < 50; ++column) map.cells[static_cast<std::size_t>(10 * 60 + column)] = 255;
  map.cells[0] = 0;
  return map;
}

}  // namespace

TEST_CASE("a semantic GeoTIFF is read back by GDAL, every band in its place") {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/semantic.tif";
  write_geotiff(path, sample_layers(), sample_map());
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> file(static_cast<GDALDataset*>(GDALOpen(path.c_str(), GA_ReadOnly)));
  REQUIRE(file);
  REQUIRE(file->GetRasterCount() == 5);
  double t[6];
  REQUIRE(file->GetGeoTransform(t) == CE_None);
  const auto at = [&](const std::string& band, double x, double y) {
    for (int k = 1; k <= 5; ++k) {
      GDALRasterBand* raster = file->GetRasterBand(k);
      if (raster->GetDescription() != band) continue;
      std::int32_t value = 0;
      REQUIRE(raster->RasterIO(GF_Read, static_cast<int>((x - t[0]) / t[1]), static_cast<int>((y - t[3]) / t[5]), 1, 1, &value, 1, 1, GDT_Int32, 0, 0) ==
              CE_None);
      return value;
    }
    return -99;
  };
  REQUIRE(at("occupancy", -0.95, -0.95) == -1);
  REQUIRE(at("occupancy", 2, 1) == 0);
  REQUIRE(at("occupancy", 2.05, 0.05) == 100);
  REQUIRE(at("rooms", 2, 2.5) == 3);
  REQUIRE(at("rooms", -0.5, 2.5) == 0);
  REQUIRE(at("walls", 2.05, 0.05) == 7);
  REQUIRE(at("walls", 2, 1) == 0);
  REQUIRE(at("doors", 4.02, 1.5) == 5);
  REQUIRE(at("objects", 1.8, 1.3) == 9);
}

TEST_CASE("a DXF is read back by OGR with its layers and names") {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/semantic.dxf";
  write_dxf(path, sample_layers());
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> file(static_cast<GDALDataset*>(GDALOpenEx(path.c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr)));
  REQUIRE(file);
  std::map<std::string, int> count;
  std::string words;
  for (const auto& feature : *file->GetLayer(0)) {
    ++count[feature->GetFieldAsString("Layer")];
    if (std::string(feature->GetFieldAsString("Layer")) == "NAMES") words = feature->GetFieldAsString("Text");
  }
  REQUIRE(count == std::map<std::string, int>{{"WALLS", 1}, {"DOORS", 1}, {"ROOMS", 1}, {"OBJECTS", 1}, {"NAMES", 1}});
  REQUIRE(words == "Room 3 _big_");
}

TEST_CASE("a PGM map is read back by annotate's reader as it was") {
  const TemporaryFolder folder;
  std::ofstream(folder.path + "/map.pgm", std::ios::binary) << map_server_pgm(sample_map());
  std::ofstream(folder.path + "/map.yaml") << map_server_yaml(sample_map(), "map.pgm");
  const MapImage again = read_grid_map(folder.path + "/map.yaml");
  REQUIRE(again.width == 60);
  REQUIRE(again.cells == sample_map().cells);
  REQUIRE(again.origin_m == sample_map().origin_m);
}

TEST_CASE("semantic.geojson comes back as it was written") {
  const std::string text = semantic_geojson(sample_layers());
  const SemanticLayers again = parse_layers(text);
  REQUIRE(semantic_geojson(again) == text);
  REQUIRE(again.doors[0].closed);
  REQUIRE(again.places[0].kind == PlaceKind::kDoorway);
  for (const char* bad : {"", "[]", "{\"features\": [{\"properties\": {\"kind\": \"room\"}, \"geometry\": {\"type\": \"Point\"}}]}"})
    REQUIRE_THROWS_AS(parse_layers(bad), std::runtime_error);
}

TEST_CASE("what cannot be written is said with its name") {
  const TemporaryFolder folder;
  const std::string gone = folder.path + "/gone/a";
  REQUIRE_THROWS_WITH(write_geotiff(gone + ".tif", {}, sample_map()), Catch::Matchers::Contains(gone + ".tif"));
  REQUIRE_THROWS_WITH(write_dxf(gone + ".dxf", sample_layers()), Catch::Matchers::Contains(gone + ".dxf"));
  REQUIRE_THROWS_WITH(write_geotiff("a.tif", {}, {}), Catch::Matchers::Contains("empty"));
}
