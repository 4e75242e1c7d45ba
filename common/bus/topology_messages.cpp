// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/topology_messages.hpp"

#include <algorithm>
#include <cstdio>
#include <set>
#include <stdexcept>

namespace modslam {
namespace {

constexpr std::size_t kMostRooms = 500, kMostDoors = 700;  // 50 kB

std::string metres(double value) {
  char words[32];
  std::snprintf(words, sizeof words, "%.1f", value);
  return words;
}

void add_room(const Topology& topology, std::size_t room, answer_t& out) {
  out.room.push_back(topology.rooms[room].id);
  out.name.push_back(topology.rooms[room].name.substr(0, 60));
  out.building.push_back(topology.building[room]);
}

void answer_room_at(const Topology& topology, const query_t& query, answer_t& out) {
  const RoomPlace place = find_place(topology, query.from);
  const Room& room = topology.rooms[place.room];
  add_room(topology, place.room, out);
  out.words = room.name + " (" + (room.corridor ? "corridor" : "room") + ", id " + std::to_string(room.id) + "), " + metres(room.area_m2) + " m2";
}

void answer_route(const Topology& topology, const query_t& query, answer_t& out) {
  const RoomPlace from = find_place(topology, query.from), to = find_place(topology, query.to);
  const auto route = find_route(topology, from, to);
  if (!route) throw std::runtime_error("no known way leads from " + topology.rooms[from.room].name + " to " + topology.rooms[to.room].name);
  if (route->rooms.size() > kMostRooms) throw std::runtime_error("the way leads through more rooms than an answer can name");
  for (std::size_t k = 0; k < route->rooms.size(); ++k) {
    add_room(topology, route->rooms[k], out);
    out.words += topology.rooms[route->rooms[k]].name;
    if (k >= route->doors.size()) break;
    const std::int64_t door = route->doors[k];
    out.words += door ? ", through door " + std::to_string(door) + " to " : ", through an opening to ";
    out.door.push_back(door);
    out.room_a.push_back(topology.rooms[route->rooms[k]].id);
    out.room_b.push_back(topology.rooms[route->rooms[k + 1]].id);
  }
  out.words += ": " + metres(route->length_m) + " m";
  for (const Eigen::Vector2d& p : route->points) {
    out.x.push_back(p.x());
    out.y.push_back(p.y());
  }
  out.length_m = route->length_m;
}

void answer_map(const Topology& topology, answer_t& out) {
  for (std::size_t k = 0; k < std::min(kMostRooms, topology.rooms.size()); ++k) add_room(topology, k, out);
  for (std::size_t k = 0; k < std::min(kMostDoors, topology.passages.size()); ++k) {
    const Passage& passage = topology.passages[k];
    out.door.push_back(passage.door);
    out.room_a.push_back(topology.rooms[passage.room_a].id);
    out.room_b.push_back(topology.rooms[passage.room_b].id);
  }
  const std::set<std::int64_t> buildings(topology.building.begin(), topology.building.end());
  out.words = std::to_string(topology.rooms.size()) + " rooms, " + std::to_string(topology.passages.size()) + " ways between them, " +
              std::to_string(buildings.size()) + " groups of joined rooms";
  if (topology.rooms.size() > kMostRooms || topology.passages.size() > kMostDoors) out.words += "; not all fit into this answer";
}

}  // namespace

answer_t answer(const Topology& topology, const query_t& query, std::int64_t utime) {
  answer_t out{};
  out.utime = utime;
  out.id = query.id;
  out.requester = query.requester.substr(0, 200);
  out.result = answer_t::FOUND;
  try {
    if (query.from.size() > 200 || query.to.size() > 200) throw std::invalid_argument("the names are longer than 200 letters");
    switch (query.kind) {
      case query_t::ROOM_AT: answer_room_at(topology, query, out); break;
      case query_t::ROUTE: answer_route(topology, query, out); break;
      case query_t::MAP: answer_map(topology, out); break;
      default: throw std::invalid_argument("there is no query of kind " + std::to_string(query.kind));
    }
  } catch (const std::invalid_argument& error) {
    out.result = answer_t::BAD_QUERY;
    out.words = error.what();
  } catch (const std::runtime_error& error) {
    out.result = answer_t::NOTHING;
    out.words = error.what();
  }
  out.nrooms = static_cast<std::int32_t>(out.room.size());
  out.ndoors = static_cast<std::int32_t>(out.door.size());
  out.npoints = static_cast<std::int32_t>(out.x.size());
  return out;
}

}  // namespace modslam
