// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/semantic_record.hpp"

#include "common/bus/semantic_messages.hpp"
#include "common/semantics/semantic_files.hpp"

namespace modslam::report {

const char* room_type_name(int type) {
  return type == room_t::ROOM ? "room" : type == room_t::CORRIDOR ? "corridor" : "unknown";
}

const char* door_state_name(int state) {
  return state == door_t::OPEN ? "open" : state == door_t::CLOSED ? "closed" : "unknown";
}

std::string semantic_geojson(const SemanticRecord& record) {
  SemanticLayers layers;
  for (const wall_t& m : record.walls.items()) layers.walls.push_back(from_message(m));
  for (const room_t& m : record.rooms.items()) layers.rooms.push_back(from_message(m));
  for (const door_t& m : record.doors.items()) layers.doors.push_back(from_message(m));
  for (const object_t& m : record.objects.items()) layers.objects.push_back(from_message(m));
  return modslam::semantic_geojson(layers);
}

}  // namespace modslam::report
