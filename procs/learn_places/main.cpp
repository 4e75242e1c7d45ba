// SPDX-License-Identifier: BSD-3-Clause
/// procs/learn_places — worlds with a route `tour` → the classifiers of places (config/places.yml), and how well they do elsewhere.
#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "common/formats/atomic_file.hpp"
#include "procs/learn_places/drive.hpp"
#include "procs/learn_places/learn.hpp"
#include "procs/learn_places/office_maker.hpp"

namespace {

using namespace modslam;

constexpr std::uint64_t kOffices = 24, kFurnitureSeed = 41;
constexpr const char* kLasers[] = {"sick", "urg", "hokuyo-270"};

/// With lasers of short and long reach and of different fields of view.
std::vector<LabelledDrive> drives_through(const World& world, double scale, std::uint64_t first_seed) {
  std::vector<LabelledDrive> drives;
  DriveOptions options;
  options.scale = scale;
  options.seed = first_seed;
  for (const char* model : kLasers) {
    options.laser.model = model;
    drives.push_back({model, drive(world, route_of(world, "tour"), options)});
    ++options.seed;
  }
  return drives;
}

/// Bare and furnished, as drawn and larger and smaller.
void drive_all_through(const World& bare, Building& building) {
  const World full = furnished(bare, route_of(bare, "tour"), kFurnitureSeed);
  constexpr std::uint64_t kBareSeed = 1, kFullSeed = 4;
  for (LabelledDrive& drive : drives_through(bare, 1, kBareSeed)) building.drives.push_back(std::move(drive));
  for (LabelledDrive& drive : drives_through(full, 1, kFullSeed)) building.drives.push_back(std::move(drive));
  for (const double scale : {0.7, 1.5}) {
    for (LabelledDrive& drive : drives_through(bare, scale, kBareSeed)) building.scaled.push_back(std::move(drive.path));
    for (LabelledDrive& drive : drives_through(full, scale, kFullSeed)) building.scaled.push_back(std::move(drive.path));
  }
}

/// Made-up buildings are only learned from.
std::vector<PlacePath> drives_through_offices() {
  std::vector<PlacePath> paths;
  for (std::uint64_t seed = 1; seed <= kOffices; ++seed) {
    const World office = make_office(seed);
    DriveOptions options;
    options.seed = seed;
    options.laser.model = kLasers[seed % 3];
    paths.push_back(drive(seed % 2 ? office : furnished(office, office.routes[0], seed), office.routes[0], options));
  }
  return paths;
}

/// "NAME=FILE": worlds of the same name are one building.
std::vector<Building> drive_all(const std::vector<std::string>& worlds) {
  std::map<std::string, Building> buildings;
  for (const std::string& word : worlds) {
    const std::size_t cut = word.find('=');
    if (cut == std::string::npos) throw std::runtime_error("'" + word + "': expected BUILDING=WORLD.geojson");
    Building& building = buildings[word.substr(0, cut)];
    building.name = word.substr(0, cut);
    drive_all_through(load_world(word.substr(cut + 1)), building);
    std::cerr << word << ": driven" << std::endl;
  }
  std::vector<Building> out;
  for (auto& [name, building] : buildings) out.push_back(std::move(building));
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Learns to tell rooms, corridors and doorways apart.");
  std::vector<std::string> worlds;
  std::string out, markdown, json;
  bool held_out = false;
  app.add_option("worlds", worlds, "BUILDING=WORLD.geojson, each with a route `tour`")->required();
  app.add_option("--out", out, "write the model learned from all of them here");
  app.add_flag("--held-out", held_out, "score each building with a model that never saw it");
  app.add_option("--markdown", markdown, "write the scores as a table")->needs("--held-out");
  app.add_option("--json", json, "write the scores for programs")->needs("--held-out");
  CLI11_PARSE(app, argc, argv);
  try {
    const std::vector<PlacePath> offices = drives_through_offices();
    const std::vector<Building> buildings = drive_all(worlds);
    if (held_out) {
      const std::vector<BuildingScore> scores = score_held_out(buildings, offices);
      std::cout << scores_markdown(scores);
      if (!markdown.empty()) write_atomically(markdown, scores_markdown(scores));
      if (!json.empty()) write_atomically(json, scores_json(scores));
    }
    if (out.empty()) return 0;
    write_atomically(out, learn(buildings, offices, nullptr).text());
    std::cout << out << " written\n";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "modslam-learn-places: " << error.what() << std::endl;
    return 1;
  }
}
