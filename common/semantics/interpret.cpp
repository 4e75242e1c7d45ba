// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/interpret.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "common/semantics/door_map.hpp"
#include "common/semantics/furniture.hpp"
#include "common/semantics/object_finder.hpp"
#include "common/semantics/room_finder.hpp"

namespace modslam {
namespace {

constexpr double kAtOutline_m = 0.2;  // walls lie this near the outline of their room
constexpr double kBehind_m = 0.2;     // a face hides what lies this far behind it

/// Whether most of the wall's face has cells of the mask right behind it.
bool stands_on(const cv::Mat1b& mask, const Wall& wall, const KnownSpace& space) {
  int behind = 0, looked = 0;
  for (double s = 0.1; s < wall.length_m(); s += 0.1, ++looked)
    for (const double depth : {0.0, 0.1}) {
      const cv::Point c = space.cell(wall.a + s * wall.direction() - depth * wall.normal());
      if (space.inside(c) && !mask.empty() && mask(c)) {
        ++behind;
        break;
      }
    }
  return 2 * behind > looked;
}

/// Takes out of the objects what is a piece of wall between two doors, with furniture against it or
/// without: its face goes on, in line, beyond a gap no wider than a door, as a wall that stands on
/// no object.
void drop_pieces_of_wall(ObjectMap& found, const std::vector<WallBand>& bands,
                         const KnownSpace& space, const SemanticsConfig& config) {
  const cv::Mat1b all = found.mask.clone();
  const auto goes_on = [&](const Wall& face, const Wall& next, double gap_m) {
    return gap_m <= config.door_max_m && next.length_m() > 1.0 && face.length_m() > 1.0 &&
           !stands_on(all, next, space);
  };
  const auto is_wall = [&](const Object& object) {
    cv::Mat1b mask(all.size(), std::uint8_t{0});
    std::vector<cv::Point> ring;
    for (const Eigen::Vector2d& p : object.outline) ring.push_back(space.cell(p));
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{ring}, cv::Scalar(255));
    for (const WallBand& band : bands)
      for (std::size_t k = 0; k + 1 < band.walls.size(); ++k) {
        const Wall &p = band.walls[k], &q = band.walls[k + 1];
        const double gap_m = (q.a - p.b).norm();
        if ((stands_on(mask, p, space) && goes_on(p, q, gap_m)) ||
            (stands_on(mask, q, space) && goes_on(q, p, gap_m))) {
          found.mask.setTo(0, mask);
          return true;
        }
      }
    return false;
  };
  found.objects.erase(std::remove_if(found.objects.begin(), found.objects.end(), is_wall),
                      found.objects.end());
}

/// Walls without the faces of furniture, band by band.
std::vector<Wall> find_walls(const SemanticEvidence& evidence, ObjectMap& objects,
                             const SemanticsConfig& config) {
  const KnownSpace& space = evidence.space;
  WallMapOptions options;
  options.min_length_m = config.wall_min_m;
  options.min_sightings = static_cast<int>(config.wall_sightings);
  const auto is_solid = [&](const Eigen::Vector2d& p) {
    const cv::Point c = space.cell(p);
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx)
        if (space.is_occupied(c + cv::Point(dx, dy))) return true;
    return false;
  };
  std::vector<WallBand> bands = merge_segments(evidence.scans, options, is_solid);
  drop_pieces_of_wall(objects, bands, space, config);
  for (WallBand& band : bands) {
    // The face of a thing that stands free is not a wall: what lies behind it belongs to the
    // object.
    const auto is_face = [&](const Wall& wall) { return stands_on(objects.mask, wall, space); };
    band.walls.erase(std::remove_if(band.walls.begin(), band.walls.end(), is_face),
                     band.walls.end());
  }
  std::vector<Wall> faces;
  for (const WallBand& band : bands)
    faces.insert(faces.end(), band.walls.begin(), band.walls.end());
  const std::vector<bool> furniture =
      find_furniture(faces, [&](const Eigen::Vector2d& p) { return space.is_free(space.cell(p)); });
  std::vector<Wall> walls;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (furniture[k]) continue;
    Wall& wall = faces[k];
    double sum = 0;
    int count = 0;
    for (double s = 0.05; s < wall.length_m(); s += 0.1, ++count)
      sum += evidence.wall_log_odds(wall.a + s * wall.direction());
    wall.evidence = count ? sum / count : 0.0;
    walls.push_back(wall);
  }
  return walls;
}

/// Faces that stand in a room, off its outline, with what nobody saw behind them, belong to what is in the room: parked cars, beds, counters.
void drop_faces_in_rooms(std::vector<Wall>& walls, const std::vector<Room>& rooms, const Floor& floor, const KnownSpace& space) {
  cv::Mat1b hidden(space.occupancy.size(), std::uint8_t{0});
  std::vector<std::vector<cv::Point>> rings;
  for (const Room& room : rooms) {
    rings.emplace_back();
    for (const Eigen::Vector2d& p : room.outline) rings.back().push_back(space.cell(p));
    cv::fillPoly(hidden, std::vector<std::vector<cv::Point>>{rings.back()}, cv::Scalar(255));
  }
  cv::polylines(hidden, rings, true, cv::Scalar(0), 2 * static_cast<int>(std::lround(kAtOutline_m / space.resolution_m)) + 1);
  hidden.setTo(0, floor.open);
  const auto hides = [&](const Wall& wall) {
    int behind = 0, looked = 0;
    for (double s = 0.1; s < wall.length_m(); s += 0.1, ++looked) {
      const cv::Point c = space.cell(wall.a + s * wall.direction() - kBehind_m * wall.normal());
      behind += space.inside(c) && hidden(c);
    }
    return 2 * behind > looked;
  };
  walls.erase(std::remove_if(walls.begin(), walls.end(), hides), walls.end());
}

/// A door leads to rooms; a small space behind it that is none was seen through it and may be anything.
void drop_doors_to_glimpses(std::vector<Door>& doors, const Partition& partition, const std::vector<Room>& rooms, double cell_m, double glimpse_m2) {
  std::set<int> doubtful = glimpses(partition, cell_m, glimpse_m2);
  for (const Room& room : rooms) doubtful.erase(room.region);
  const auto leads_there = [&](const Door& door) { return doubtful.count(door.region_a) + doubtful.count(door.region_b) > 0; };
  doors.erase(std::remove_if(doors.begin(), doors.end(), leads_there), doors.end());
}

}  // namespace

SemanticLayers interpret(const SemanticEvidence& evidence, const SemanticsConfig& config, const OpeningModel& model) {
  const KnownSpace& space = evidence.space;
  SemanticLayers layers;
  ObjectMap objects = find_objects(space, config.object_max_m2);
  layers.walls = find_walls(evidence, objects, config);
  layers.objects = objects.objects;
  const Floor floor = make_floor(space, config.object_max_m2);
  PartitionOptions parting;
  parting.min_probability = config.opening_probability;
  parting.min_room_m2 = config.room_min_m2;
  const std::vector<Opening> openings = find_openings(floor, space, layers.walls, config.opening_max_m, model);
  const Partition partition = part_floor(floor, space, layers.walls, openings, parting);
  DoorMapOptions doors;
  doors.min_width_m = config.door_min_m;
  doors.max_width_m = config.door_max_m;
  layers.doors = find_doors(partition, evidence.sightings, doors);
  RoomOptions rooms;
  rooms.min_area_m2 = config.room_min_m2;
  rooms.min_enclosed = config.room_enclosed;
  rooms.min_explored = config.room_explored;
  layers.rooms = find_rooms(partition, floor, space, rooms);
  drop_doors_to_glimpses(layers.doors, partition, layers.rooms, space.resolution_m, rooms.glimpse_m2);
  drop_faces_in_rooms(layers.walls, layers.rooms, floor, space);
  return layers;
}

}  // namespace modslam
