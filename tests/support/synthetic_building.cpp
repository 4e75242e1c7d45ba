// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/synthetic_building.hpp"

#include <cstdio>

#include "tests/support/synthetic_scan.hpp"

namespace modslam::test {

const SyntheticBuilding& synthetic_building() {
  static const SyntheticBuilding building = {
      {{0, 0, 3.5, 0}, {4.5, 0, 11.5, 0}, {12.5, 0, 16, 0}, {16, -2, 16, 8}, {16, 8, 0, 8}, {0, 8, 0, -2}, {0, -2, 16, -2}, {8, 0, 8, 3}, {8, 5, 8, 8}},
      {{8, 3, 8, 5}, {3.5, 0, 4.5, 0}, {11.5, 0, 12.5, 0}},
      {{2.6, 3.7, 3.2, 4.3}, {12.8, 3.7, 13.4, 4.3}}};
  return building;
}

Scan scan_building(const Pose2& T_world_laser, std::int64_t utime) {
  static const Plan solid = [] {
    Plan plan;
    for (const auto& [x0, y0, x1, y1] : synthetic_building().walls) plan.push_back({{x0, y0}, {x1, y1}});
    for (const auto& [x0, y0, x1, y1] : synthetic_building().pillars) add_box(plan, x0, y0, x1, y1);
    return plan;
  }();
  Scan scan{utime, {}, -kPi / 2, kPi / 180};
  for (int i = 0; i <= 180; ++i)
    scan.ranges_m.push_back(static_cast<float>(cast_ray(solid, T_world_laser.translation(), T_world_laser.heading + scan.bearing_rad(i), 30.0)));
  return scan;
}

std::string synthetic_world_geojson() {
  std::string features;
  const auto add = [&](const char* kind, const Segment& s) {
    features += std::string(features.empty() ? "" : ",") +
                "{\"type\":\"Feature\",\"properties\":{\"kind\":\"" + kind +
                "\"},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[" +
                std::to_string(s[0]) + "," + std::to_string(s[1]) + "],[" + std::to_string(s[2]) +
                "," + std::to_string(s[3]) + "]]}}\n";
  };
  for (const Segment& s : synthetic_building().walls) add("wall", s);
  for (const Segment& s : synthetic_building().doors) add("door", s);
  const Segment rooms[] = {{0, 0, 8, 8}, {8, 0, 16, 8}, {0, -2, 16, 0}};  // x0 y0 x1 y1
  int id = 0;
  for (const auto& [x0, y0, x1, y1] : rooms) {
    char room[400];
    std::snprintf(room, sizeof room,
                  ",{\"type\":\"Feature\",\"properties\":{\"kind\":\"room\",\"id\":%d},"
                  "\"geometry\":{\"type\":"
                  "\"Polygon\",\"coordinates\":[[[%g,%g],[%g,%g],[%g,%g],[%g,%g],[%g,%g]]]}}\n",
                  ++id, x0, y0, x1, y0, x1, y1, x0, y1, x0, y0);
    features += room;
  }
  return "{\"type\":\"FeatureCollection\",\"features\":[" + features + "]}\n";
}

}  // namespace modslam::test
