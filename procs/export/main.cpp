// SPDX-License-Identifier: BSD-3-Clause
/// procs/export — the folder of a run or of an annotated map → GeoTIFF, DXF, SVG, map_server PGM.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "common/formats/atomic_file.hpp"
#include "common/formats/file_bytes.hpp"
#include "common/formats/grid_map.hpp"
#include "common/formats/map_server.hpp"
#include "common/semantics/layers_reader.hpp"
#include "common/semantics/semantic_files.hpp"
#include "procs/export/export.hpp"

namespace {

using namespace modslam;

SemanticLayers layers_in(const std::string& path) {
  try {
    return parse_layers(read_file_bytes(path).bytes);
  } catch (const std::runtime_error& error) {
    const std::string why = error.what();
    throw std::runtime_error(why.rfind(path, 0) == 0 ? why : path + ": " + why);
  }
}

void run(const std::string& folder, const std::string& out, const std::string& map_path, const std::vector<std::string>& formats) {
  const auto wanted = [&](const char* name) { return std::find(formats.begin(), formats.end(), name) != formats.end(); };
  std::filesystem::create_directories(out);
  std::string written;
  const auto path_of = [&](const char* name) {
    written += (written.empty() ? "" : ", ") + std::string(name);
    return out + "/" + name;
  };
  const bool needs_layers = wanted("geotiff") || wanted("dxf") || wanted("svg"), needs_map = wanted("geotiff") || wanted("pgm");
  const SemanticLayers layers = needs_layers ? layers_in(folder + "/semantic.geojson") : SemanticLayers();
  const MapImage map = needs_map ? read_grid_map(map_path.empty() ? folder + "/map.yaml" : map_path) : MapImage();
  if (wanted("geotiff")) write_geotiff(path_of("semantic.tif"), layers, map);
  if (wanted("dxf")) write_dxf(path_of("semantic.dxf"), layers);
  if (wanted("svg")) write_atomically(path_of("semantic.svg"), semantic_svg(layers));
  if (wanted("pgm")) {
    write_atomically(path_of("map.pgm"), map_server_pgm(map));
    write_atomically(path_of("map.yaml"), map_server_yaml(map, "map.pgm"));
  }
  std::cout << out << ": " << written << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Writes a semantic map for other programs.");
  std::string folder, out, map;
  std::vector<std::string> formats = {"geotiff", "dxf", "svg", "pgm"};
  app.add_option("DIR", folder, "folder with semantic.geojson and map.yaml")->required();
  app.add_option("--format", formats, "geotiff, dxf, svg, pgm; with commas between [all]")->delimiter(',')->check(CLI::IsMember({"geotiff", "dxf", "svg", "pgm"}));
  app.add_option("--out", out, "folder for the files [DIR/export]");
  app.add_option("--map", map, "map_server YAML of the grid map [DIR/map.yaml]");
  CLI11_PARSE(app, argc, argv);
  try {
    run(folder, out.empty() ? folder + "/export" : out, map, formats);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "modslam-export: " << error.what() << std::endl;
    return 1;
  }
}
