// SPDX-License-Identifier: BSD-3-Clause
#include "common/topology/topology.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/bus/topology_messages.hpp"

using namespace modslam;

namespace {

Room box(std::int64_t id, double x0, double y0, double x1, double y1, bool corridor = false) {
  Room room;
  room.id = id;
  room.corridor = corridor;
  room.name = (corridor ? "Corridor " : "Room ") + std::to_string(id);
  room.area_m2 = (x1 - x0) * (y1 - y0);
  room.outline = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  return room;
}

Door door(std::int64_t id, double x, double y, std::int64_t a, std::int64_t b) {
  Door out;
  out.id = id;
  out.a = {x - 0.4, y};
  out.b = {x + 0.4, y};
  out.room_a = a;
  out.room_b = b;
  return out;
}

/// Rooms 1, 2, 3 side by side above corridor 4, each with a door to it; 1 and 2 also have a door between them; 9 stands apart.
SemanticLayers floor() {
  SemanticLayers layers;
  layers.rooms = {box(1, 0, 2, 4, 6), box(2, 4, 2, 8, 6), box(3, 8, 2, 12, 6), box(4, 0, 0, 12, 2, true), box(9, 20, 0, 24, 4)};
  layers.doors = {door(11, 2, 2, 1, 4), door(12, 6, 2, 2, 4), door(13, 10, 2, 3, 4), door(14, 4, 5, 1, 2), door(15, 22, 4, 9, 0)};
  return layers;
}

query_t question(std::int8_t kind, const std::string& from, const std::string& to = "") {
  query_t query{};
  query.id = 5;
  query.requester = "tester";
  query.kind = kind;
  query.from = from;
  query.to = to;
  return query;
}

}  // namespace

TEST_CASE("a point belongs to the room that holds it, or is beside") {
  const Topology topology = build_topology(floor(), {});
  REQUIRE(topology.rooms[room_at(topology, {1, 4}).value()].id == 1);
  REQUIRE(topology.rooms[room_at(topology, {11, 1}).value()].id == 4);
  REQUIRE(topology.rooms[room_at(topology, {-0.3, 4}).value()].id == 1);
  REQUIRE_FALSE(room_at(topology, {-3, 4}));
  REQUIRE_FALSE(room_at(topology, {std::numeric_limits<double>::quiet_NaN(), 4}));
}

TEST_CASE("a route is the shortest way through doors") {
  const Topology topology = build_topology(floor(), {});
  const RoomRoute near = find_route(topology, find_place(topology, "1 5"), find_place(topology, "7 5")).value();
  REQUIRE(near.doors == std::vector<std::int64_t>{14});
  REQUIRE(near.length_m == Approx(6));
  const RoomRoute far = find_route(topology, find_place(topology, "room 1"), find_place(topology, "3")).value();
  REQUIRE(far.doors == std::vector<std::int64_t>{11, 13});
  REQUIRE(far.rooms.size() == 3);
  REQUIRE(topology.rooms[far.rooms[1]].corridor);
  double walked = 0;
  for (std::size_t k = 1; k < far.points.size(); ++k) walked += (far.points[k] - far.points[k - 1]).norm();
  REQUIRE(far.length_m == Approx(walked));
  const RoomRoute here = find_route(topology, find_place(topology, "1 1"), find_place(topology, "4 1")).value();
  REQUIRE(here.doors.empty());
  REQUIRE(here.length_m == Approx(3));
}

TEST_CASE("a route back is the same way") {
  const Topology topology = build_topology(floor(), {});
  for (const char* a : {"1", "2", "3", "4"})
    for (const char* b : {"1", "2", "3", "4"}) {
      RoomRoute there = find_route(topology, find_place(topology, a), find_place(topology, b)).value();
      const RoomRoute back = find_route(topology, find_place(topology, b), find_place(topology, a)).value();
      std::reverse(there.doors.begin(), there.doors.end());
      REQUIRE(there.doors == back.doors);
      REQUIRE(there.length_m == Approx(back.length_m));
    }
}

TEST_CASE("rooms that doors join are one building, and a room without a way is its own") {
  const Topology topology = build_topology(floor(), {});
  REQUIRE(topology.building == std::vector<std::int64_t>{1, 1, 1, 1, 9});
  REQUIRE_FALSE(find_route(topology, find_place(topology, "1"), find_place(topology, "9")));
}

TEST_CASE("where the path goes from room to room without a door there is an opening") {
  SemanticLayers layers = floor();
  layers.doors.clear();
  std::vector<Eigen::Vector2d> path = {{1, 1}, {2, 1.8}, {2, 2.2}, {2, 4}, {2, 2.1}, {2, 1.5}};
  const Topology topology = build_topology(layers, path);
  REQUIRE(topology.passages.size() == 1);
  REQUIRE(topology.passages[0].door == 0);
  REQUIRE((topology.passages[0].p - Eigen::Vector2d(2, 2)).norm() < 0.01);
  REQUIRE(topology.room_of_node == std::vector<std::int64_t>{4, 4, 1, 1, 1, 4});
}

TEST_CASE("two nodes far apart are no step from room to room: between them the robot drove through known space") {
  SemanticLayers layers = floor();
  layers.doors.clear();
  const Topology topology = build_topology(layers, {{11, 1}, {2, 4}});
  REQUIRE(topology.room_of_node == std::vector<std::int64_t>{4, 1});
  REQUIRE(topology.passages.empty());
}

TEST_CASE("the hierarchy is written from building over room to node") {
  const auto json = nlohmann::json::parse(topology_json(build_topology(floor(), {{1, 1}, {1, 4}, {50, 50}})));
  REQUIRE(json["buildings"].size() == 2);
  REQUIRE(json["buildings"][0]["rooms"] == nlohmann::json({1, 2, 3, 4}));
  REQUIRE(json["rooms"][0]["nodes"] == nlohmann::json({1}));
  REQUIRE(json["rooms"][3]["type"] == "corridor");
  REQUIRE(json["passages"].size() == 4);
}

TEST_CASE("queries are answered in words and numbers, and bad ones say what is wrong") {
  const Topology topology = build_topology(floor(), {});
  const answer_t room = answer(topology, question(query_t::ROOM_AT, "1, 4"), 7);
  REQUIRE(room.result == answer_t::FOUND);
  REQUIRE(room.room == std::vector<std::int64_t>{1});
  REQUIRE(room.requester == "tester");
  REQUIRE(room.id == 5);
  const answer_t route = answer(topology, question(query_t::ROUTE, "ROOM 1", "3"), 7);
  REQUIRE(route.words == "Room 1, through door 11 to Corridor 4, through door 13 to Room 3: " + route.words.substr(route.words.size() - 6));
  REQUIRE(route.nrooms == 3);
  REQUIRE(route.npoints == 4);
  REQUIRE(answer(topology, question(query_t::MAP, ""), 7).ndoors == 4);
  REQUIRE(answer(topology, question(query_t::ROUTE, "1", "9"), 7).result == answer_t::NOTHING);
  for (const auto& query : {question(query_t::ROOM_AT, "cellar"), question(query_t::ROOM_AT, ""), question(query_t::ROOM_AT, "99 99"), question(77, "1"),
                            question(query_t::ROOM_AT, "nan nan"), question(query_t::ROOM_AT, std::string(5000, 'x'))}) {
    const answer_t bad = answer(topology, query, 7);
    REQUIRE(bad.result == answer_t::BAD_QUERY);
    REQUIRE(bad.words.size() > 10);
    REQUIRE(bad.nrooms == 0);
  }
  REQUIRE(answer(Topology(), question(query_t::MAP, ""), 7).nrooms == 0);
}

TEST_CASE("an answer about two thousand rooms fits into a message") {
  SemanticLayers layers;
  for (int k = 0; k < 2000; ++k) {
    layers.rooms.push_back(box(k + 1, 5 * k, 0, 5 * k + 5, 4));
    if (k) layers.doors.push_back(door(k, 5 * k, 2, k, k + 1));
  }
  const answer_t map = answer(build_topology(layers, {}), question(query_t::MAP, ""), 7);
  REQUIRE(map.getEncodedSize() < 60000);
  REQUIRE(map.words.find("not all fit") != std::string::npos);
}

TEST_CASE("broken outlines and a hundred thousand nodes do no harm") {
  SemanticLayers layers = floor();
  layers.rooms.push_back(box(20, 0, 0, std::numeric_limits<double>::quiet_NaN(), 1));
  layers.rooms.push_back(Room());
  layers.doors.push_back(door(30, std::numeric_limits<double>::infinity(), 0, 1, 4));
  std::vector<Eigen::Vector2d> path;
  for (int k = 0; k < 100'000; ++k) path.push_back({12.0 * k / 100'000, 1});
  path.push_back({std::numeric_limits<double>::quiet_NaN(), 1});
  const Topology topology = build_topology(layers, path);
  REQUIRE(topology.rooms.size() == 5);
  REQUIRE(topology.room_of_node.size() == path.size());
  REQUIRE(build_topology({}, {}).rooms.empty());
}
