// SPDX-License-Identifier: BSD-3-Clause
/// procs/annotate — a finished grid map (map_server YAML) → walls, rooms, doors, objects on it.
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "common/semantics/partition.hpp"
#include "common/formats/grid_map.hpp"

using namespace modslam;
int main(int argc, char** argv) {
  CLI::App app("Says what is on a finished grid map.");
  std::string map, out;
  app.add_option("map", map)->required();
  app.add_option("--openings", out)->required();
  CLI11_PARSE(app, argc, argv);
  const KnownSpace space(read_grid_map(map), 0.05);
  const Floor floor = make_floor(space, 14);
  std::ofstream file(out);
  const auto openings = find_openings(floor, space, 3.5);
  const Partition parts = part_floor(floor, space, openings, 0.5, 1.5);
  std::ofstream labels(out + ".labels");
  labels << space.origin_m.x() << " " << space.origin_m.y() << " " << parts.labels.cols << " " << parts.labels.rows << "\n";
  for (const int v : parts.labels) labels << v << " ";
  std::ofstream cuts(out + ".cuts");
  for (const CutOpening& c : parts.cuts) cuts << c.opening.a.x() << "," << c.opening.a.y() << "," << c.opening.b.x() << "," << c.opening.b.y() << "," << c.opening.probability << "\n";
  for (const Opening& o : openings) {
    file << o.a.x() << "," << o.a.y() << "," << o.b.x() << "," << o.b.y() << "," << o.probability;
    for (const float f : o.features) file << "," << f;
    file << "\n";
  }
}
