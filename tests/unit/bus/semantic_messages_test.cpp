// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/semantic_messages.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "common/world/random.hpp"
#include "tests/support/stage.hpp"

using namespace modslam;

namespace {

constexpr int kMostBytes = 60000;

std::vector<wall_list_t> wall_chunks(const std::vector<wall_t>& walls) {
  return to_chunks<wall_list_t>(walls, 5, 3, [](wall_list_t& list, const std::vector<wall_t>& part) {
    list.walls = part;
    list.nwalls = static_cast<std::int32_t>(part.size());
  });
}

std::vector<room_list_t> room_chunks(const std::vector<room_t>& rooms) {
  return to_chunks<room_list_t>(rooms, 5, 3, [](room_list_t& list, const std::vector<room_t>& part) {
    list.rooms = part;
    list.nrooms = static_cast<std::int32_t>(part.size());
  });
}

template <class Message>
Message over_the_wire(const Message& message) {
  REQUIRE(message.getEncodedSize() < kMostBytes);
  test::Stage stage;
  const auto& heard = stage.record<Message>("LIST");
  stage.bus("speaker").publish("LIST", message);
  stage.drain();
  REQUIRE(heard.size() == 1);
  return heard[0];
}

std::vector<Eigen::Vector2d> star(int corners) {
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * kPi * k / corners, radius_m = k % 2 ? 20 : 19;
    outline.push_back(radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return outline;
}

}  // namespace

TEST_CASE("3000 walls come through in chunks below 60 kB, each once, in order") {
  RandomStream random(705, RandomStreamId::kLaser);
  std::vector<wall_t> walls;
  for (int k = 0; k < 3000; ++k) {
    Wall wall;
    wall.id = k + 1;
    wall.a = {random.uniform(-50, 50), random.uniform(-50, 50)};
    wall.b = {random.uniform(-50, 50), random.uniform(-50, 50)};
    wall.evidence = random.uniform(-6, 6);
    wall.sigma_m = 0.01;
    walls.push_back(to_message(wall));
  }
  const auto chunks = wall_chunks(walls);
  REQUIRE(chunks.size() > 2);
  std::size_t next = 0;
  for (std::size_t k = 0; k < chunks.size(); ++k) {
    const wall_list_t list = over_the_wire(chunks[k]);
    REQUIRE(list.chunk == static_cast<int>(k));
    REQUIRE(list.nchunks == static_cast<int>(chunks.size()));
    REQUIRE(list.version == 3);
    REQUIRE(list.utime == 5);
    REQUIRE(list.nwalls == static_cast<int>(list.walls.size()));
    for (const wall_t& wall : list.walls) {
      REQUIRE(wall.id == walls[next].id);
      REQUIRE(wall.a[0] == walls[next].a[0]);
      REQUIRE(wall.b[1] == walls[next].b[1]);
      REQUIRE(wall.evidence == walls[next].evidence);
      ++next;
    }
  }
  REQUIRE(next == walls.size());
}

TEST_CASE("an empty list is one empty chunk, so that the end of the last thing is told too") {
  const auto chunks = wall_chunks({});
  REQUIRE(chunks.size() == 1);
  REQUIRE(over_the_wire(chunks[0]).nwalls == 0);
  REQUIRE(chunks[0].nchunks == 1);
}

TEST_CASE("a door, a room and an object keep what they are on the wire") {
  Door door;
  door.id = 4;
  door.a = {1, 2};
  door.b = {1, 2.9};
  door.room_a = 7;
  door.room_b = 9;
  const door_t told = over_the_wire(to_message(door));
  REQUIRE(told.id == 4);
  REQUIRE(told.width_m == Approx(0.9));
  REQUIRE(told.room_a == 7);
  REQUIRE(told.room_b == 9);
  REQUIRE(told.state == door_t::OPEN);
  Wall wall;
  wall.a = {1, 2};
  wall.b = {3, 2};
  wall.at_a = {0.01, 0.02, true};
  wall.at_b = {0.03, 1.0, false};
  const Wall there = from_message(over_the_wire(to_message(wall)));
  REQUIRE(there.at_a.across_m == 0.01);
  REQUIRE(there.at_a.along_m == 0.02);
  REQUIRE(there.at_a.seen);
  REQUIRE(there.at_b.across_m == 0.03);
  REQUIRE(there.at_b.along_m == 1.0);
  REQUIRE_FALSE(there.at_b.seen);
  Room room;
  room.name = "Corridor 3";
  room.corridor = true;
  room.outline = star(12);
  const room_t heard = over_the_wire(to_message(room));
  REQUIRE(heard.name == "Corridor 3");
  REQUIRE(heard.type == room_t::CORRIDOR);
  REQUIRE(heard.npoints == 12);
  REQUIRE(heard.x[3] == room.outline[3].x());
  Object object;
  object.class_name = "car";
  object.class_confidence = 0.9;
  object.outline = star(5);
  const object_t seen = over_the_wire(to_message(object, 77));
  REQUIRE(seen.class_name == "car");
  REQUIRE(from_message(seen).class_confidence == 0.9);
  REQUIRE(seen.last_utime == 77);
  REQUIRE(seen.npoints == 5);
}

TEST_CASE("a room with more corners than a message may hold is told with fewer, below 60 kB") {
  Room big;
  big.outline = star(9001);
  const room_t told = to_message(big);
  REQUIRE(told.npoints == static_cast<int>(told.x.size()));
  REQUIRE(told.npoints > 1000);
  for (const room_list_t& chunk : room_chunks({told, told, told})) over_the_wire(chunk);
}

TEST_CASE("20000 places come through in chunks below 60 kB, and wild ones are refused") {
  std::vector<Place> places(20000);
  for (std::size_t k = 0; k < places.size(); ++k) {
    places[k].node = static_cast<std::int64_t>(k);
    places[k].kind = static_cast<PlaceKind>(k % 3);
    places[k].confidence = 0.5 + 0.5 * static_cast<double>(k % 7) / 7;
  }
  std::vector<Place> again;
  const auto chunks = to_place_chunks(places, 5, 3);
  for (const place_list_t& chunk : chunks)
    for (const Place& place : from_message(over_the_wire(chunk))) again.push_back(place);
  REQUIRE(chunks.size() == 3);
  REQUIRE(again.size() == places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    REQUIRE(again[k].node == places[k].node);
    REQUIRE(again[k].kind == places[k].kind);
    REQUIRE(again[k].confidence == Approx(places[k].confidence));
  }
  REQUIRE(to_place_chunks({}, 5, 3).size() == 1);
  const auto refused = [&](auto damage) {
    place_list_t wild = chunks[0];
    damage(wild);
    REQUIRE_THROWS_AS(from_message(wild), BadMessage);
  };
  refused([](place_list_t& m) { m.kind[3] = 3; });
  refused([](place_list_t& m) { m.kind[3] = -1; });
  refused([](place_list_t& m) { m.confidence[3] = std::numeric_limits<float>::quiet_NaN(); });
  refused([](place_list_t& m) { m.confidence[3] = 1.5f; });
  refused([](place_list_t& m) { m.first_node = -1; });
}
