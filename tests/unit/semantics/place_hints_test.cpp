// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/place_hints.hpp"

#include <catch2/catch.hpp>

using namespace modslam;

namespace {

Room box(double x0, double y0, double x1, double y1, bool corridor) {
  Room room;
  room.corridor = corridor;
  room.outline = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  return room;
}

/// A room over a corridor, with a door between them at x = 2.
SemanticLayers room_and_corridor() {
  SemanticLayers layers;
  layers.rooms = {box(0, 0, 4, 3, false), box(-10, -2, 10, 0, true)};
  Door door;
  door.a = {1.5, 0};
  door.b = {2.5, 0};
  layers.doors = {door};
  return layers;
}

}  // namespace

TEST_CASE("the map says of a place which room it is in, and doors before rooms") {
  const SemanticLayers layers = room_and_corridor();
  const PlaceHints hints(layers);
  CHECK(hints.at({2, 1.5}).hint == PlaceHint::kInRoom);
  CHECK(hints.at({-8, -1}).hint == PlaceHint::kInCorridor);
  CHECK(hints.at({2, 0.35}).hint == PlaceHint::kAtDoor);
  CHECK(hints.at({1.2, -0.2}).hint == PlaceHint::kAtDoor);   // beside a jamb
  CHECK(hints.at({2, 0.45}).hint == PlaceHint::kInRoom);
  CHECK(hints.at({1, -0.2}).hint == PlaceHint::kInCorridor);
  CHECK(hints.at({20, 1}).hint == PlaceHint::kNone);
  CHECK(hints.at({20, 1}).room == -1);
  CHECK(hints.at({1, 1}).room == hints.at({3, 2.5}).room);
  CHECK(hints.at({1, 1}).room != hints.at({1, -1}).room);
}

TEST_CASE("an empty map says nothing of any place") {
  const SemanticLayers layers;
  CHECK(PlaceHints(layers).at({0, 0}).hint == PlaceHint::kNone);
}
