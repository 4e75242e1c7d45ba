// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "procs/report/map_view.hpp"

namespace modslam::report {

WorldOutline read_world_outline(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be opened");
  WorldOutline world;
  try {
    const nlohmann::json json = nlohmann::json::parse(in);
    for (const auto& feature : json.at("features")) {
      const std::string kind = feature.at("properties").at("kind");
      if ((kind != "wall" && kind != "door") || feature.at("geometry").at("type") != "LineString")
        continue;
      Points points;
      for (const auto& p : feature.at("geometry").at("coordinates"))
        points.push_back({p.at(0).get<double>(), p.at(1).get<double>()});
      (kind == "wall" ? world.walls : world.doors).push_back(points);
    }
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(path + ": is no GeoJSON of a world: " + error.what());
  }
  return world;
}

}  // namespace modslam::report
