// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/semantic_messages.hpp"

#include <algorithm>

#include "common/bus/bus.hpp"

namespace modslam {
namespace {

constexpr std::size_t kMostCorners = 2500;  // 40 kB: an outline must fit into one chunk

/// Of an outline with too many corners every n-th is told.
template <class Message>
void put_outline(Message& message, const std::vector<Eigen::Vector2d>& outline) {
  const std::size_t stride = outline.size() / (kMostCorners + 1) + 1;
  for (std::size_t k = 0; k < outline.size(); k += stride) {
    const Eigen::Vector2d& p = outline[k];
    message.x.push_back(p.x());
    message.y.push_back(p.y());
  }
  message.npoints = static_cast<std::int32_t>(message.x.size());
}

template <class Message>
void put_ends(Message& message, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  message.a[0] = a.x();
  message.a[1] = a.y();
  message.b[0] = b.x();
  message.b[1] = b.y();
}

template <class Message>
std::vector<Eigen::Vector2d> outline_of(const Message& message) {
  std::vector<Eigen::Vector2d> outline;
  for (std::size_t k = 0; k < message.x.size() && k < message.y.size(); ++k) outline.emplace_back(message.x[k], message.y[k]);
  return outline;
}

}  // namespace

Wall from_message(const wall_t& message) {
  Wall wall;
  wall.id = message.id;
  wall.a = {message.a[0], message.a[1]};
  wall.b = {message.b[0], message.b[1]};
  wall.evidence = message.evidence;
  wall.sigma_m = message.sigma_m;
  wall.at_a = {message.sigma_across_m[0], message.sigma_along_m[0], message.end_seen[0] != 0};
  wall.at_b = {message.sigma_across_m[1], message.sigma_along_m[1], message.end_seen[1] != 0};
  return wall;
}

Door from_message(const door_t& message) {
  Door door;
  door.id = message.id;
  door.a = {message.a[0], message.a[1]};
  door.b = {message.b[0], message.b[1]};
  door.evidence = message.evidence;
  door.closed = message.state == door_t::CLOSED;
  door.room_a = message.room_a;
  door.room_b = message.room_b;
  return door;
}

Room from_message(const room_t& message) {
  Room room;
  room.id = message.id;
  room.name = message.name;
  room.corridor = message.type == room_t::CORRIDOR;
  room.area_m2 = message.area_m2;
  room.explored = message.explored;
  room.evidence = message.evidence;
  room.outline = outline_of(message);
  return room;
}

Object from_message(const object_t& message) {
  Object object;
  object.id = message.id;
  object.class_name = message.class_name;
  object.class_confidence = message.class_confidence;
  object.area_m2 = message.area_m2;
  object.evidence = message.evidence;
  object.outline = outline_of(message);
  return object;
}

wall_t to_message(const Wall& wall) {
  wall_t message{};
  message.id = wall.id;
  put_ends(message, wall.a, wall.b);
  message.evidence = wall.evidence;
  message.sigma_m = wall.sigma_m;
  for (const auto& [k, end] : {std::pair(0, wall.at_a), std::pair(1, wall.at_b)}) {
    message.sigma_across_m[k] = end.across_m;
    message.sigma_along_m[k] = end.along_m;
    message.end_seen[k] = end.seen;
  }
  return message;
}

door_t to_message(const Door& door) {
  door_t message{};
  message.id = door.id;
  put_ends(message, door.a, door.b);
  message.width_m = door.width_m();
  message.evidence = door.evidence;
  message.room_a = door.room_a;
  message.room_b = door.room_b;
  message.state = door.closed ? door_t::CLOSED : door_t::OPEN;
  return message;
}

room_t to_message(const Room& room) {
  room_t message{};
  message.id = room.id;
  message.name = room.name;
  message.type = room.corridor ? room_t::CORRIDOR : room_t::ROOM;
  message.area_m2 = room.area_m2;
  message.explored = room.explored;
  message.evidence = room.evidence;
  put_outline(message, room.outline);
  return message;
}

room_event_t to_message(const RoomEvent& event) {
  room_event_t message{};
  message.kind = event.kind == RoomEvent::Kind::kMerge ? room_event_t::MERGE : room_event_t::SPLIT;
  message.before = event.before;
  message.nbefore = static_cast<std::int32_t>(event.before.size());
  message.after = event.after;
  message.nafter = static_cast<std::int32_t>(event.after.size());
  return message;
}

object_t to_message(const Object& object, std::int64_t utime) {
  object_t message{};
  message.id = object.id;
  message.class_name = object.class_name;
  message.class_confidence = object.class_confidence;
  message.area_m2 = object.area_m2;
  message.evidence = object.evidence;
  message.first_utime = message.last_utime = utime;
  put_outline(message, object.outline);
  return message;
}

std::vector<place_list_t> to_place_chunks(const std::vector<Place>& places, std::int64_t utime, std::int64_t version) {
  constexpr std::size_t kChunk = 8000;  // 40 kB
  std::vector<place_list_t> chunks;
  for (std::size_t first = 0; first == 0 || first < places.size(); first += kChunk) {
    place_list_t message{};
    message.utime = utime;
    message.version = version;
    message.chunk = static_cast<std::int32_t>(chunks.size());
    message.nchunks = static_cast<std::int32_t>(std::max<std::size_t>(1, (places.size() + kChunk - 1) / kChunk));
    message.first_node = static_cast<std::int64_t>(first);
    for (std::size_t k = first; k < std::min(first + kChunk, places.size()); ++k) {
      message.kind.push_back(static_cast<std::int8_t>(places[k].kind));
      message.confidence.push_back(static_cast<float>(places[k].confidence));
    }
    message.nplaces = static_cast<std::int32_t>(message.kind.size());
    chunks.push_back(std::move(message));
  }
  return chunks;
}

std::vector<Place> from_message(const place_list_t& message) {
  constexpr std::int64_t kMostNodes = 10'000'000;
  if (message.first_node < 0 || message.first_node > kMostNodes) throw BadMessage("places of node " + std::to_string(message.first_node));
  std::vector<Place> places;
  for (std::size_t k = 0; k < message.kind.size() && k < message.confidence.size(); ++k) {
    Place place;
    place.node = message.first_node + static_cast<std::int64_t>(k);
    if (message.kind[k] < place_list_t::ROOM || message.kind[k] > place_list_t::DOORWAY)
      throw BadMessage("a place of kind " + std::to_string(message.kind[k]));
    place.kind = static_cast<PlaceKind>(message.kind[k]);
    place.confidence = message.confidence[k];
    if (!(place.confidence >= 0 && place.confidence <= 1)) throw BadMessage("a place's confidence is not within 0 and 1");
    places.push_back(place);
  }
  return places;
}

}  // namespace modslam
