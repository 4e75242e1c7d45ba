// SPDX-License-Identifier: BSD-3-Clause
/// @file The building as a graph of rooms: rooms and corridors are its nodes, doors its edges, above the nodes of the pose graph and below
/// whole buildings (the hierarchy of Galindo et al. 2005: grid, rooms, building). It answers where one is and which way to go.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/semantics/types.hpp"

namespace modslam {

/// One way from a room to another.
struct Passage {
  std::int64_t door = 0;             ///< id of the door; 0: an opening that is none
  std::size_t room_a = 0, room_b = 0;  ///< indices into Topology::rooms
  Eigen::Vector2d p{0, 0};           ///< [m] middle of the door, map frame
};

struct Topology {
  std::vector<Room> rooms;
  std::vector<Eigen::Vector2d> middles;    ///< of each room a place inside
  std::vector<std::int64_t> building;      ///< of each room the id of its building: the smallest id of the rooms that hang together
  std::vector<Passage> passages;
  std::vector<std::int64_t> room_of_node;  ///< ids, of each node of the path that was given; 0: in none
};

/// `path`: places of the pose graph's nodes in the order of driving; where it leads from room to room without a door there is a passage all the
/// same. May be empty.
Topology build_topology(const SemanticLayers& layers, const std::vector<Eigen::Vector2d>& path);

/// Index of the room that holds the point, else of the nearest within 0.6 m (in a doorway); none: nothing.
std::optional<std::size_t> room_at(const Topology& topology, const Eigen::Vector2d& p);

/// A room and where in it.
struct RoomPlace {
  std::size_t room = 0;
  Eigen::Vector2d p{0, 0};
};

/// The place that a person means: "X Y" in metres, a room's name (case does not matter) or its id.
/// @throws std::invalid_argument in words for that person.
RoomPlace find_place(const Topology& topology, const std::string& words);

struct RoomRoute {
  std::vector<std::size_t> rooms;          ///< indices; one more than doors
  std::vector<std::int64_t> doors;         ///< ids; 0: a passage without a door
  std::vector<Eigen::Vector2d> points;     ///< start, passages, end
  double length_m = 0;                     ///< straight from point to point
};

/// The shortest way; nothing when the rooms do not hang together.
std::optional<RoomRoute> find_route(const Topology& topology, const RoomPlace& from, const RoomPlace& to);

/// Rooms, passages, buildings and the nodes in each room, for programs (topology.json of a run).
std::string topology_json(const Topology& topology);

}  // namespace modslam
