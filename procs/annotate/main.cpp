// SPDX-License-Identifier: BSD-3-Clause
/// procs/annotate — a finished grid map (map_server YAML) → walls, rooms, doors, objects on it. Config: [semantics].
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "common/bus/config.hpp"
#include "common/bus/system_config.hpp"
#include "common/formats/atomic_file.hpp"
#include "common/formats/grid_map.hpp"
#include "common/semantics/map_annotator.hpp"
#include "common/semantics/partition.hpp"
#include "common/semantics/semantic_files.hpp"

namespace {

using namespace modslam;

/// Every opening with its features, one a line: what `train semantics` learns from.
std::string openings_csv(const KnownSpace& space, const std::vector<Wall>& walls, const SemanticsConfig& config) {
  std::ostringstream out;
  const OpeningModel model(config.opening_trees, kind_of(space));
  for (const Opening& o : find_openings(make_floor(space, config.object_max_m2), space, walls, config.opening_max_m, model)) {
    out << o.a.x() << ',' << o.a.y() << ',' << o.b.x() << ',' << o.b.y() << ',' << o.probability;
    for (const float f : o.features) out << ',' << f;
    out << '\n';
  }
  return out.str();
}

void run(const std::string& map, const std::string& out, bool openings, const SemanticsConfig& config) {
  const AnnotatedMap found = annotate(read_grid_map(map), config);
  std::filesystem::create_directories(out);
  write_atomically(out + "/semantic.geojson", semantic_geojson(found.layers));
  write_atomically(out + "/semantic.svg", semantic_svg(found.layers));
  if (openings) write_atomically(out + "/openings.csv", openings_csv(found.space, found.layers.walls, config));
  std::cout << map << ": " << found.layers.walls.size() << " walls, " << found.layers.rooms.size() << " rooms, " << found.layers.doors.size()
            << " doors, " << found.layers.objects.size() << " objects\n"
            << (kind_of(found.space) == OpeningModel::Kind::kFinished ? "  a finished map\n" : "  a map that is open to the unexplored\n")
            << "  results  " << out << "/semantic.geojson, semantic.svg\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Says what is on a finished grid map.");
  std::string map, out, config_path = "config/modslam.toml";
  std::vector<std::string> overrides;
  bool openings = false;
  app.add_option("map", map, "map_server YAML of a trinary map")->required();
  app.add_option("--out", out, "folder for the results")->required();
  app.add_option("--config", config_path, "configuration file")->capture_default_str();
  app.add_option("--set", overrides, "table.key=value, over the file; repeatable");
  app.add_flag("--openings", openings, "also write openings.csv, which training reads");
  CLI11_PARSE(app, argc, argv);
  try {
    run(map, out, openings, load_config(config_path, overrides).semantics);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "modslam-annotate: " << error.what() << std::endl;
    return 1;
  }
}
