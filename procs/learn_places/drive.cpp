// SPDX-License-Identifier: BSD-3-Clause
#include "procs/learn_places/drive.hpp"

#include <algorithm>

#include "common/places/panorama.hpp"
#include "common/places/scan_features.hpp"
#include "common/semantics/place_hints.hpp"
#include "common/semantics/room_finder.hpp"
#include "common/semantics/semantic_mapper.hpp"
#include "common/world/random.hpp"
#include "common/world/world_simulation.hpp"

namespace modslam {
namespace {

constexpr double kDoorway_m = 0.4, kNode_m = 0.30, kNode_rad = 0.35;
constexpr double kClearOfTour_m = 0.55, kClearOfDoor_m = 0.9, kFloorPerBox_m2 = 6;

double distance_to_line(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (a + t * d - p).norm();
}

bool is_in(const WorldRoom& room, const Eigen::Vector2d& p) {
  if (!contains(room.polygon, p)) return false;
  return std::none_of(room.holes.begin(), room.holes.end(), [&](const auto& hole) { return contains(hole, p); });
}

bool stands_in_the_way(const World& world, const Route& tour, const Eigen::Vector2d& p) {
  for (std::size_t k = 1; k < tour.points.size(); ++k)
    if (distance_to_line(p, tour.points[k - 1], tour.points[k]) < kClearOfTour_m) return true;
  return std::any_of(world.doors.begin(), world.doors.end(),
                     [&](const WorldDoor& door) { return distance_to_line(p, door.a, door.b) < kClearOfDoor_m; });
}

Scan sweep(const Obstacles& obstacles, const DriveOptions& options, const Pose2& T_world_base, std::uint64_t number) {
  const LaserConfig& config = options.laser;
  const LaserModel model = laser_model(config.model);
  const Pose2 T_world_laser = T_world_base * simulated_sensor(config).T_base_laser;
  Scan scan;
  scan.rad0 = model.rad0;
  scan.radstep = model.radstep;
  for (int k = 0; k < model.beams; ++k)
    scan.ranges_m.push_back(static_cast<float>(
        options.scale *
        obstacles.cast(T_world_laser.translation(), T_world_laser.heading + scan.bearing_rad(static_cast<std::size_t>(k)), model.range_max_m / options.scale)));
  add_laser_noise(scan.ranges_m, config, model, options.seed, number);
  return scan;
}

}  // namespace

bool place_in(const World& world, const Eigen::Vector2d& p, PlaceKind& kind) {
  kind = PlaceKind::kDoorway;
  for (const WorldDoor& door : world.doors)
    if (distance_to_line(p, door.a, door.b) <= kDoorway_m) return true;
  for (const WorldRoom& room : world.rooms) {
    if (!is_in(room, p)) continue;
    kind = room.category == "corridor" && room.name != "HALL" ? PlaceKind::kCorridor : PlaceKind::kRoom;
    return true;
  }
  return false;
}

World furnished(World world, const Route& tour, std::uint64_t seed) {
  RandomStream random(seed, RandomStreamId::kLaser);
  int count = 0;
  for (const WorldRoom& room : world.rooms) {
    if (room.category == "corridor") continue;
    Eigen::Vector2d low = room.polygon[0], high = low;
    for (const Eigen::Vector2d& p : room.polygon) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const int tries = static_cast<int>((high - low).prod() / kFloorPerBox_m2);
    for (int n = 0; n < tries; ++n) {
      const Eigen::Vector2d centre(random.uniform(low.x(), high.x()), random.uniform(low.y(), high.y()));
      const double half_x = 0.5 * random.uniform(0.3, 1.8), half_y = 0.5 * random.uniform(0.3, 0.9), turn = random.uniform(0, kPi);
      WorldObject box{"box" + std::to_string(count++), "box", {}};
      const Eigen::Matrix2d R = rotation(turn);
      for (const auto& [sx, sy] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) box.polygon.push_back(centre + R * Eigen::Vector2d(sx * half_x, sy * half_y));
      bool fits = is_in(room, centre) && !stands_in_the_way(world, tour, centre);
      for (std::size_t k = 0; k < 4 && fits; ++k)
        fits = !stands_in_the_way(world, tour, box.polygon[k]) && !stands_in_the_way(world, tour, 0.5 * (box.polygon[k] + box.polygon[(k + 1) % 4]));
      if (fits) world.objects.push_back(box);
    }
  }
  return world;
}

PlacePath drive(const World& world, const Route& tour, const DriveOptions& options) {
  const Obstacles obstacles(world);
  const SensorInfo sensor = simulated_sensor(options.laser);
  WorldSimulation simulation(world, tour, false);
  PanoramaMaker panorama;
  SemanticMapper mapper{SemanticsConfig()};
  PlacePath path;
  std::vector<Eigen::Vector2d> places;
  Pose2 last;
  for (std::uint64_t number = 0; !simulation.state().finished; simulation.advance()) {
    const Pose2 now = simulation.state().T_world_base;
    if (number > 0 && options.scale * distance(now, last) < kNode_m && std::abs(wrap_angle(now.heading - last.heading)) < kNode_rad) continue;
    last = now;
    const Pose2 scaled(options.scale * now.x, options.scale * now.y, now.heading);
    PlaceSample sample;
    const Scan scan = sweep(obstacles, options, now, number++);
    mapper.add_node(scan, sensor, scaled);
    sample.features = place_features(panorama.add(scan, sensor, scaled));
    if (!place_in(world, now.translation(), sample.kind)) continue;
    path.push_back(std::move(sample));
    places.push_back(scaled.translation());
  }
  const SemanticLayers& layers = mapper.update(true);
  const PlaceHints map(layers);
  for (std::size_t k = 0; k < path.size(); ++k) path[k].on_map = map.at(places[k]);
  return path;
}

}  // namespace modslam
