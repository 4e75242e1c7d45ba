// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/semantic_messages.hpp"

#include <cmath>

#include "common/bus/channels.hpp"

namespace modslam {
namespace {

constexpr int kMaxChunkBytes = 50000;

void put(double (&values)[2], const Eigen::Vector2d& p) {
  values[0] = p.x();
  values[1] = p.y();
}

double finite(double value, const char* what) {
  if (!std::isfinite(value)) throw BadMessage(std::string(what) + " is not finite");
  return value;
}

Eigen::Vector2d to_point(const double (&values)[2]) {
  return {finite(values[0], "x"), finite(values[1], "y")};
}

template <class Message>
void put_outline(Message& message, const Polygon& outline) {
  message.npoints = static_cast<std::int32_t>(outline.size());
  for (const Eigen::Vector2d& p : outline) {
    message.x.push_back(p.x());
    message.y.push_back(p.y());
  }
}

template <class Message>
Polygon to_outline(const Message& message) {
  if (message.npoints < 3)
    throw BadMessage("outline of " + std::to_string(message.npoints) + " corners");
  Polygon outline;
  for (std::size_t i = 0; i < message.x.size(); ++i)
    outline.emplace_back(finite(message.x[i], "x"), finite(message.y[i], "y"));
  return outline;
}

wall_t to_message(const Wall& wall) {
  wall_t m{};
  m.id = wall.id;
  put(m.a, wall.segment.a);
  put(m.b, wall.segment.b);
  m.evidence = wall.evidence;
  m.sigma_m = wall.sigma_m;
  return m;
}

room_t to_message(const Room& room) {
  room_t m{};
  m.id = room.id;
  m.name = room.name;
  m.type = room.type == RoomType::kCorridor ? room_t::CORRIDOR : room_t::ROOM;
  m.area_m2 = room.area_m2;
  m.explored = room.explored;
  m.evidence = room.evidence;
  put_outline(m, room.outline);
  return m;
}

door_t to_message(const Door& door) {
  door_t m{};
  m.id = door.id;
  put(m.a, door.segment.a);
  put(m.b, door.segment.b);
  m.width_m = door.width_m();
  m.evidence = door.evidence;
  m.room_a = door.room_a;
  m.room_b = door.room_b;
  m.state = door_t::OPEN;
  return m;
}

object_t to_message(const Object& object) {
  object_t m{};
  m.id = object.id;
  m.class_name = object.class_name;
  m.area_m2 = object.area_m2;
  m.evidence = object.evidence;
  m.first_utime = object.first_utime;
  m.last_utime = object.last_utime;
  put_outline(m, object.outline);
  return m;
}

/// Fills chunks up to kMaxChunkBytes. `list_of` and `count_of` name the array and its length in the
/// message.
template <class Message, class Thing, class Item>
std::vector<Message> chunked(const std::vector<Thing>& things, std::vector<Item> Message::*list_of,
                             std::int32_t Message::*count_of, std::int64_t utime,
                             std::int64_t version) {
  std::vector<Message> chunks(1);
  int bytes = 0;
  for (const Thing& thing : things) {
    Item item = to_message(thing);
    const int size = item.getEncodedSize();
    if (bytes + size > kMaxChunkBytes && bytes > 0) {
      chunks.emplace_back();
      bytes = 0;
    }
    bytes += size;
    (chunks.back().*list_of).push_back(std::move(item));
  }
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    Message& m = chunks[i];
    m.utime = utime;
    m.version = version;
    m.chunk = static_cast<std::int32_t>(i);
    m.nchunks = static_cast<std::int32_t>(chunks.size());
    m.*count_of = static_cast<std::int32_t>((m.*list_of).size());
  }
  return chunks;
}

}  // namespace

std::vector<wall_list_t> to_messages(const std::vector<Wall>& walls, std::int64_t utime,
                                     std::int64_t version) {
  return chunked(walls, &wall_list_t::walls, &wall_list_t::nwalls, utime, version);
}
std::vector<room_list_t> to_messages(const std::vector<Room>& rooms, std::int64_t utime,
                                     std::int64_t version) {
  return chunked(rooms, &room_list_t::rooms, &room_list_t::nrooms, utime, version);
}
std::vector<door_list_t> to_messages(const std::vector<Door>& doors, std::int64_t utime,
                                     std::int64_t version) {
  return chunked(doors, &door_list_t::doors, &door_list_t::ndoors, utime, version);
}
std::vector<object_list_t> to_messages(const std::vector<Object>& objects, std::int64_t utime,
                                       std::int64_t version) {
  return chunked(objects, &object_list_t::objects, &object_list_t::nobjects, utime, version);
}

std::vector<Wall> to_things(const wall_list_t& message) {
  std::vector<Wall> out;
  for (const wall_t& m : message.walls)
    out.push_back({m.id,
                   {to_point(m.a), to_point(m.b)},
                   finite(m.evidence, "evidence"),
                   finite(m.sigma_m, "sigma_m")});
  return out;
}

std::vector<Room> to_things(const room_list_t& message) {
  std::vector<Room> out;
  for (const room_t& m : message.rooms) {
    if (m.type != room_t::ROOM && m.type != room_t::CORRIDOR)
      throw BadMessage("room " + std::to_string(m.id) + " has type " + std::to_string(m.type));
    out.push_back({m.id, m.name, m.type == room_t::CORRIDOR ? RoomType::kCorridor : RoomType::kRoom,
                   finite(m.area_m2, "area_m2"), finite(m.explored, "explored"),
                   finite(m.evidence, "evidence"), to_outline(m)});
  }
  return out;
}

std::vector<Door> to_things(const door_list_t& message) {
  std::vector<Door> out;
  for (const door_t& m : message.doors)
    out.push_back(
        {m.id, {to_point(m.a), to_point(m.b)}, finite(m.evidence, "evidence"), m.room_a, m.room_b});
  return out;
}

std::vector<Object> to_things(const object_list_t& message) {
  std::vector<Object> out;
  for (const object_t& m : message.objects)
    out.push_back({m.id, m.class_name, finite(m.area_m2, "area_m2"), finite(m.evidence, "evidence"),
                   m.first_utime, m.last_utime, to_outline(m)});
  return out;
}

SemanticMirror::SemanticMirror(Bus& bus) {
  const auto take = [this](auto& assembler, const auto& message) {
    if (assembler.add(message) && on_change) on_change();
  };
  bus.subscribe<wall_list_t>(channel::kWalls,
                             [this, take](const wall_list_t& m) { take(walls_, m); });
  bus.subscribe<room_list_t>(channel::kRooms,
                             [this, take](const room_list_t& m) { take(rooms_, m); });
  bus.subscribe<door_list_t>(channel::kDoors,
                             [this, take](const door_list_t& m) { take(doors_, m); });
  bus.subscribe<object_list_t>(channel::kObjects,
                               [this, take](const object_list_t& m) { take(objects_, m); });
}

}  // namespace modslam
