// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/semantic_record.hpp"

#include "common/bus/semantic_messages.hpp"

namespace modslam::report {

const char* room_type_name(int type) {
  return type == room_t::ROOM ? "room" : type == room_t::CORRIDOR ? "corridor" : "unknown";
}

const char* door_state_name(int state) {
  return state == door_t::OPEN ? "open" : state == door_t::CLOSED ? "closed" : "unknown";
}

std::vector<Place> PlaceItems::of(const place_list_t& message) { return from_message(message); }

SemanticLayers layers_of(const SemanticRecord& record, const std::map<NodeId, Pose2>& nodes) {
  SemanticLayers layers;
  for (const wall_t& m : record.walls.items()) layers.walls.push_back(from_message(m));
  for (const room_t& m : record.rooms.items()) layers.rooms.push_back(from_message(m));
  for (const door_t& m : record.doors.items()) layers.doors.push_back(from_message(m));
  for (const object_t& m : record.objects.items()) layers.objects.push_back(from_message(m));
  for (Place place : record.places.items()) {
    const auto node = nodes.find(place.node);
    if (node == nodes.end()) continue;
    place.p = node->second.translation();
    layers.places.push_back(place);
  }
  return layers;
}

}  // namespace modslam::report
