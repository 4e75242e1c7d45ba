// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/synthetic_map.hpp"

#include <algorithm>
#include <cmath>
#include <modslam/door_list_t.hpp>
#include <modslam/object_list_t.hpp>
#include <modslam/room_list_t.hpp>
#include <modslam/wall_list_t.hpp>

#include "common/bus/channels.hpp"
#include "common/maps/mosaic.hpp"
#include "tests/support/synthetic_building.hpp"

namespace modslam::test {
namespace {

constexpr double kResolution_m = 0.05;
constexpr int kTile_cells = 128;

template <class List, class Item>
List whole_list(std::int64_t utime, std::vector<Item> List::*items, std::int32_t List::*count,
                std::vector<Item> values) {
  List list{};
  list.utime = utime;
  list.version = 3;
  list.nchunks = 1;
  list.*count = static_cast<int>(values.size());
  list.*items = std::move(values);
  return list;
}

room_t make_room(std::int64_t id, const char* name, int type, const Pose2& T_map_world, double x0,
                 double y0, double x1, double y1) {
  room_t room{};
  room.id = id;
  room.name = name;
  room.type = static_cast<std::int8_t>(type);
  room.area_m2 = (x1 - x0) * (y1 - y0);
  room.explored = 0.97;
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}}) {
    room.x.push_back((T_map_world * p).x());
    room.y.push_back((T_map_world * p).y());
  }
  room.npoints = 4;
  return room;
}

template <class Item>
void put_line(Item& item, const Pose2& T_map_world, const Segment& s) {
  const Eigen::Vector2d a = T_map_world * Eigen::Vector2d(s[0], s[1]),
                        b = T_map_world * Eigen::Vector2d(s[2], s[3]);
  item.a[0] = a.x(), item.a[1] = a.y(), item.b[0] = b.x(), item.b[1] = b.y();
}

}  // namespace

void Canvas::add(const Pose2& T_map_laser, const Scan& scan) {
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i)
    for (double r = 0; r <= scan.ranges_m[i] + 1e-6; r += kResolution_m / 2) {
      const double angle = T_map_laser.heading + scan.bearing_rad(i);
      touch(T_map_laser.x + r * std::cos(angle), T_map_laser.y + r * std::sin(angle),
            r > scan.ranges_m[i] - kResolution_m / 2);
    }
}

std::vector<map_tile_t> Canvas::tiles(std::int64_t utime) const {
  std::vector<map_tile_t> out;
  for (const auto& [place, odds] : odds_) {
    std::vector<std::uint8_t> cells;
    for (const double o : odds)
      cells.push_back(
          o == 0 ? 0 : static_cast<std::uint8_t>(1 + std::lround(254 / (1 + std::exp(-o)))));
    map_tile_t tile{};
    tile.utime = utime;
    tile.version = 1;
    tile.tile_x = place.first;
    tile.tile_y = place.second;
    tile.ncells = kTile_cells;
    tile.resolution_m = kResolution_m;
    tile.encoding = map_tile_t::ZLIB;
    tile.data = pack_cells(cells);
    tile.nbytes = static_cast<int>(tile.data.size());
    out.push_back(tile);
  }
  return out;
}

void Canvas::touch(double x, double y, bool hit) {
  const int column = static_cast<int>(std::floor(x / kResolution_m)),
            row = static_cast<int>(std::floor(y / kResolution_m));
  const auto tile_of = [](int c) { return (c >= 0 ? c : c - kTile_cells + 1) / kTile_cells; };
  auto& odds = odds_[{tile_of(column), tile_of(row)}];
  odds.resize(kTile_cells * kTile_cells);
  double& o = odds[static_cast<std::size_t>((row - tile_of(row) * kTile_cells) * kTile_cells +
                                            column - tile_of(column) * kTile_cells)];
  o = std::clamp(o + (hit ? 1.2 : -0.15), -4.0, 4.0);
}

void write_semantics(LogWriter& log, std::int64_t utime, const Pose2& T_map_world) {
  std::vector<wall_t> walls;
  for (const Segment& s : synthetic_building().walls) {
    wall_t wall{};
    wall.id = static_cast<std::int64_t>(walls.size()) + 1;
    put_line(wall, T_map_world, s);
    wall.evidence = 3.2;
    wall.sigma_m = 0.011;
    walls.push_back(wall);
  }
  std::vector<door_t> doors;
  const std::int64_t rooms_of[3][2] = {{1, 2}, {1, 3}, {2, 3}};
  for (const Segment& s : synthetic_building().doors) {
    door_t door{};
    door.room_a = rooms_of[doors.size()][0];
    door.room_b = rooms_of[doors.size()][1];
    door.id = static_cast<std::int64_t>(doors.size()) + 1;
    put_line(door, T_map_world, s);
    door.width_m = std::hypot(s[2] - s[0], s[3] - s[1]);
    door.evidence = 2.5;
    door.state = door_t::OPEN;
    doors.push_back(door);
  }
  std::vector<object_t> objects;
  for (const auto& [x0, y0, x1, y1] : synthetic_building().pillars) {
    const room_t shape = make_room(0, "", 0, T_map_world, x0, y0, x1, y1);
    object_t object{};
    object.id = static_cast<std::int64_t>(objects.size()) + 1;
    object.class_name = "pillar";
    object.area_m2 = shape.area_m2;
    object.x = shape.x, object.y = shape.y, object.npoints = shape.npoints;
    objects.push_back(object);
  }
  wall_list_t first = whole_list(utime, &wall_list_t::walls, &wall_list_t::nwalls, walls),
              second = first;
  first.nchunks = second.nchunks = 2;
  first.walls.resize(5), first.nwalls = 5;
  second.walls.erase(second.walls.begin(), second.walls.begin() + 5),
      second.nwalls = static_cast<int>(second.walls.size());
  second.chunk = 1;
  log.write(utime, channel::kWalls, second);
  log.write(utime, channel::kWalls, first);
  log.write(utime, channel::kRooms,
            whole_list(utime, &room_list_t::rooms, &room_list_t::nrooms,
                       {make_room(1, "Workshop <A> & co", room_t::ROOM, T_map_world, 0, 0, 8, 8),
                        make_room(2, "", room_t::ROOM, T_map_world, 8, 0, 16, 8),
                        make_room(3, "", room_t::CORRIDOR, T_map_world, 0, -2, 16, 0)}));
  log.write(utime, channel::kDoors,
            whole_list(utime, &door_list_t::doors, &door_list_t::ndoors, doors));
  log.write(utime, channel::kObjects,
            whole_list(utime, &object_list_t::objects, &object_list_t::nobjects, objects));
}

}  // namespace modslam::test
