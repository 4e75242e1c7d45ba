// SPDX-License-Identifier: BSD-3-Clause
/// The semantic classifier on the in-process bus: a drive goes in, lists of walls, rooms, doors and objects come out.
#include <algorithm>
#include <modslam/answer_t.hpp>
#include <modslam/graph_node_t.hpp>
#include <modslam/query_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/semantic_messages.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stage.hpp"
#include "tests/support/two_rooms.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A robot whose true places are known, an estimator that believes them, and the classifier.
struct House {
  explicit House(const std::string& places = MODSLAM_SOURCE_DIR "/config/places.yml") {
    SystemConfig config;
    config.places.model = places;
    config.launch.estimator = "ground_truth";
    stage.host("yardstick", make_yardstick, config);
    classifier = &stage.host("semantic_classifier", make_semantic_classifier, config);
    robot.publish(channel::kSensorInfo, to_message(sensor, utime));
  }
  void drive(const Plan& plan = two_rooms()) {
    for (const Pose2& T_world_base : drive_through_two_rooms()) {
      utime += 500'000;
      robot.publish(channel::kGroundTruth, to_message(TimedPose{utime, T_world_base, 0}));
      robot.publish(channel::kOdometry, to_message(TimedPose{utime, T_world_base, 0}));
      robot.publish(channel::kLaser, to_message(see(plan, sensor, T_world_base, &random, utime)));
      stage.drain(1);
    }
  }
  void ask(const std::string& name) {
    sync_request_t request{};
    request.requester = name;
    robot.publish(channel::kSyncRequest, request);
    stage.drain();
  }
  Stage stage;
  Bus& robot = stage.bus("robot");
  SensorInfo sensor = short_laser();
  RandomStream random{706, RandomStreamId::kLaser};
  std::int64_t utime = 1'000'000'000;
  const std::vector<wall_list_t>& walls = stage.record<wall_list_t>(channel::kWalls);
  const std::vector<room_list_t>& rooms = stage.record<room_list_t>(channel::kRooms);
  const std::vector<door_list_t>& doors = stage.record<door_list_t>(channel::kDoors);
  const std::vector<place_list_t>& places = stage.record<place_list_t>(channel::kPlaces);
  const std::vector<answer_t>& answers = stage.record<answer_t>(channel::kAnswer);
  const std::vector<object_list_t>& objects = stage.record<object_list_t>(channel::kObjects);
  Module* classifier = nullptr;
};

}  // namespace

TEST_CASE("semantic_classifier tells two rooms and their door, at its pace, with rising versions") {
  House house;
  house.drive();
  const std::size_t while_driving = house.rooms.size();
  house.classifier->finish();
  house.stage.drain();
  REQUIRE(while_driving >= 5);  // every 3 s of message time, a drive of half a minute
  REQUIRE(while_driving <= 12);
  REQUIRE(house.rooms.size() == while_driving + 1);
  for (std::size_t k = 1; k < house.rooms.size(); ++k) REQUIRE(house.rooms[k].version == house.rooms[k - 1].version + 1);
  REQUIRE(house.rooms.back().nrooms == 2);
  REQUIRE(house.doors.back().ndoors == 1);
  const door_t& door = house.doors.back().doors[0];
  REQUIRE(door.room_a != door.room_b);
  for (const room_t& room : house.rooms.back().rooms) REQUIRE((room.id == door.room_a || room.id == door.room_b));
  REQUIRE(house.walls.back().nwalls >= 8);
  REQUIRE(house.objects.back().nobjects == 0);
  REQUIRE(house.walls.back().utime == house.rooms.back().utime);
  REQUIRE_THAT(house.classifier->words(), Catch::Matchers::Contains("2 rooms, 1 doors"));
}

TEST_CASE("semantic_classifier tells, in the one version where it happened, that two rooms became one") {
  House house;
  house.drive();
  for (const room_list_t& list : house.rooms) REQUIRE(list.nevents == 0);
  Plan hall;
  add_box(hall, -4, -3, 4, 3);
  for (int lap = 0; lap < 6; ++lap) house.drive(hall);
  house.classifier->finish();
  house.stage.drain();
  REQUIRE(house.rooms.back().nrooms == 1);
  int merges = 0;
  for (std::size_t k = 1; k < house.rooms.size(); ++k)
    for (const room_event_t& event : house.rooms[k].events) {
      REQUIRE(event.kind == room_event_t::MERGE);
      REQUIRE(event.before == std::vector<std::int64_t>{house.rooms[k - 1].rooms[0].id, house.rooms[k - 1].rooms[1].id});
      REQUIRE(event.after == std::vector<std::int64_t>{house.rooms[k].rooms[0].id});
      ++merges;
    }
  REQUIRE(merges == 1);
}

TEST_CASE("semantic_classifier tells since when it has seen an object, and how sure it is of its class") {
  House house;
  Plan plan = two_rooms();
  add_box(plan, -2.3, -0.35, -1.7, 0.2);
  for (int lap = 0; lap < 2; ++lap) house.drive(plan);
  house.classifier->finish();
  house.stage.drain();
  REQUIRE(house.objects.back().nobjects == 1);
  const object_t object = house.objects.back().objects[0];
  REQUIRE(object.last_utime == house.objects.back().utime);
  REQUIRE((object.class_confidence > 0) != object.class_name.empty());
  const auto first = std::find_if(house.objects.begin(), house.objects.end(), [&](const object_list_t& list) {
    return std::any_of(list.objects.begin(), list.objects.end(), [&](const object_t& o) { return o.id == object.id; });
  });
  REQUIRE(object.first_utime == first->utime);
  REQUIRE(object.first_utime < object.last_utime);
}

TEST_CASE("semantic_classifier answers SYNC_REQUEST with what it told last, and not its own") {
  House house;
  house.ask("too early");
  REQUIRE(house.rooms.empty());
  house.drive();
  house.classifier->finish();
  house.stage.drain();
  const room_list_t last = house.rooms.back();
  const std::size_t before = house.rooms.size();
  house.ask("semantic_classifier");
  REQUIRE(house.rooms.size() == before);
  house.ask("latecomer");
  REQUIRE(house.rooms.size() == before + 1);
  REQUIRE(house.rooms.back().version == last.version);
  REQUIRE(house.rooms.back().nrooms == last.nrooms);
  REQUIRE(house.rooms.back().rooms[0].x == last.rooms[0].x);
}

TEST_CASE("another session's graph makes semantic_classifier forget the old building") {
  House house;
  house.drive();
  REQUIRE_THAT(house.classifier->words(), !Catch::Matchers::StartsWith("0 walls"));
  graph_node_t node{};
  node.utime = house.utime + 1'000'000'000;
  node.sensor = to_message(house.sensor, node.utime);
  node.scan = to_message(see({}, house.sensor, {}, nullptr, node.utime));
  house.robot.publish(channel::kNode, node);
  house.stage.drain();
  REQUIRE_THAT(house.classifier->words(), Catch::Matchers::StartsWith("0 walls, 0 rooms"));
}

TEST_CASE("semantic_classifier tells of each node what kind of place it is") {
  House house;
  house.drive();
  house.classifier->finish();
  house.stage.drain();
  const std::vector<Pose2> drive = drive_through_two_rooms();
  const std::vector<Place> places = from_message(house.places.back());
  REQUIRE(house.places.back().nchunks == 1);
  REQUIRE(places.size() > 20);
  REQUIRE(places.size() <= drive.size());
  int rooms = 0, doorways = 0;
  for (const Place& place : places) {
    rooms += place.kind == PlaceKind::kRoom;
    doorways += place.kind == PlaceKind::kDoorway;
  }
  REQUIRE(rooms > 0.7 * static_cast<double>(places.size()));
  REQUIRE(doorways >= 1);
  REQUIRE(house.places.back().version == house.rooms.back().version);
}

TEST_CASE("without its model semantic_classifier says that there are no places, and does all else") {
  House house("/nowhere/places.yml");
  house.drive();
  house.classifier->finish();
  house.stage.drain();
  REQUIRE(house.places.back().nplaces == 0);
  REQUIRE(house.rooms.back().nrooms == 2);
  REQUIRE_THAT(house.classifier->words(), Catch::Matchers::Contains("no places: /nowhere/places.yml"));
}

TEST_CASE("semantic_classifier answers which room is where and which way leads there") {
  House house;
  const auto ask = [&](std::int8_t kind, const std::string& from, const std::string& to) {
    query_t query{};
    query.id = static_cast<std::int64_t>(house.answers.size()) + 1;
    query.requester = "somebody";
    query.kind = kind;
    query.from = from;
    query.to = to;
    house.robot.publish(channel::kQuery, query);
    house.stage.drain();
    REQUIRE(house.answers.back().id == query.id);
    return house.answers.back();
  };
  REQUIRE(ask(query_t::ROOM_AT, "0 0", "").result == answer_t::BAD_QUERY);  // nothing is known yet
  house.drive();
  house.classifier->finish();
  house.stage.drain();
  const answer_t map = ask(query_t::MAP, "", "");
  REQUIRE(map.nrooms == 2);
  REQUIRE(map.ndoors == 1);
  REQUIRE(map.building[0] == map.building[1]);
  const answer_t route = ask(query_t::ROUTE, map.name[0], std::to_string(map.room[1]));
  REQUIRE(route.result == answer_t::FOUND);
  REQUIRE(route.door == map.door);
  REQUIRE(route.npoints == 3);
  const answer_t room = ask(query_t::ROOM_AT, std::to_string(route.x[2]) + " " + std::to_string(route.y[2]), "");
  REQUIRE(room.room == std::vector<std::int64_t>{map.room[1]});
}
