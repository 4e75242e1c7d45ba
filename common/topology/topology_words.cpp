// SPDX-License-Identifier: BSD-3-Clause
/// Places as people name them, and the topology as text.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "common/topology/topology.hpp"

namespace modslam {
namespace {

std::string lower(std::string words) {
  for (char& c : words) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return words;
}

std::string trimmed(const std::string& words) {
  const std::size_t first = words.find_first_not_of(" \t"), last = words.find_last_not_of(" \t");
  return first == std::string::npos ? "" : words.substr(first, last - first + 1);
}

/// All numbers of the words, when they are numbers and nothing else.
std::optional<std::vector<double>> numbers_in(std::string words) {
  std::replace(words.begin(), words.end(), ',', ' ');
  std::istringstream in(words);
  std::vector<double> numbers;
  for (double number = 0; in >> number;) numbers.push_back(number);
  return in.eof() && !numbers.empty() ? std::optional(numbers) : std::nullopt;
}

double rounded(double value) { return std::isfinite(value) ? std::round(value * 1e3) / 1e3 : 0.0; }

}  // namespace

RoomPlace find_place(const Topology& topology, const std::string& words) {
  const std::string wanted = trimmed(words);
  if (wanted.empty()) throw std::invalid_argument("no place is named: say \"X Y\", a room's name or its id");
  for (std::size_t k = 0; k < topology.rooms.size(); ++k)
    if (lower(topology.rooms[k].name) == lower(wanted)) return {k, topology.middles[k]};
  const auto numbers = numbers_in(wanted);
  if (numbers && numbers->size() == 2) {
    const Eigen::Vector2d p((*numbers)[0], (*numbers)[1]);
    if (const auto room = room_at(topology, p)) return {*room, p};
    throw std::invalid_argument("there is no room at " + wanted);
  }
  if (numbers && numbers->size() == 1)
    for (std::size_t k = 0; k < topology.rooms.size(); ++k)
      if (static_cast<double>(topology.rooms[k].id) == (*numbers)[0]) return {k, topology.middles[k]};
  std::string known;
  for (std::size_t k = 0; k < topology.rooms.size() && k < 20; ++k) known += (k ? ", " : "") + topology.rooms[k].name;
  if (topology.rooms.size() > 20) known += ", ...";
  throw std::invalid_argument("no room is called '" + wanted + "'; " + (known.empty() ? "none is known yet" : "there are: " + known));
}

std::string topology_json(const Topology& topology) {
  using Json = nlohmann::ordered_json;
  Json rooms = Json::array(), passages = Json::array(), buildings = Json::array();
  std::map<std::int64_t, std::vector<std::size_t>> nodes;
  for (std::size_t n = 0; n < topology.room_of_node.size(); ++n) nodes[topology.room_of_node[n]].push_back(n);
  for (std::size_t k = 0; k < topology.rooms.size(); ++k) {
    const Room& room = topology.rooms[k];
    rooms.push_back({{"id", room.id},
                     {"name", room.name},
                     {"type", room.corridor ? "corridor" : "room"},
                     {"area_m2", rounded(room.area_m2)},
                     {"middle", {rounded(topology.middles[k].x()), rounded(topology.middles[k].y())}},
                     {"building", topology.building[k]},
                     {"nodes", nodes[room.id]}});
  }
  for (const Passage& passage : topology.passages)
    passages.push_back({{"door", passage.door},
                        {"rooms", {topology.rooms[passage.room_a].id, topology.rooms[passage.room_b].id}},
                        {"at", {rounded(passage.p.x()), rounded(passage.p.y())}}});
  std::vector<std::int64_t> ids = topology.building;
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (const std::int64_t id : ids) {
    Json members = Json::array();
    for (std::size_t k = 0; k < topology.rooms.size(); ++k)
      if (topology.building[k] == id) members.push_back(topology.rooms[k].id);
    buildings.push_back({{"id", id}, {"rooms", members}});
  }
  return Json({{"buildings", buildings}, {"rooms", rooms}, {"passages", passages}}).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace modslam
