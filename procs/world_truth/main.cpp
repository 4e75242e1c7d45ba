// SPDX-License-Identifier: BSD-3-Clause
/// procs/world_truth — a drawn world → the semantic map a perfect run would find (GeoJSON).
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "common/world/truth.hpp"

namespace {

void write_truth(const std::string& input, const std::string& output) {
  const modslam::World world = modslam::load_world(input);
  std::ofstream out(output);
  out << modslam::world_truth_geojson(world);
  if (!out.flush()) throw std::runtime_error(output + ": cannot be written");
  std::cout << output << ": " << world.walls.size() << " walls, " << world.rooms.size()
            << " rooms, " << world.doors.size() << " doors, " << world.objects.size()
            << " objects\n";
}

}  // namespace

int main(int argc, char** argv) {
  std::string input, output;
  CLI::App app("Writes what is true in a world, for modslam-evaluate --world-truth.");
  app.add_option("world", input, "the drawn world (GeoJSON)")->required();
  app.add_option("truth", output, "the semantic map to write (GeoJSON)")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    write_truth(input, output);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "modslam-world-truth: " << error.what() << std::endl;
    return 1;
  }
}
