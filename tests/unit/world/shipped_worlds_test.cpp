// SPDX-License-Identifier: BSD-3-Clause
// The worlds under config/worlds keep the promises their routes are chosen by.
#include <catch2/catch.hpp>
#include <set>

#include "common/evaluation/semantic_map.hpp"
#include "common/world/truth.hpp"

using namespace modslam;

namespace {

using Points = std::vector<Eigen::Vector2d>;

World shipped(const std::string& name) {
  return load_world(MODSLAM_SOURCE_DIR "/config/worlds/" + name + ".geojson");
}

double distance_m(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double t = std::min(1.0, std::max(0.0, (p - a).dot(d) / d.squaredNorm()));
  return (p - a - t * d).norm();
}

/// Distance to the outline; 0 inside.
double distance_m(const Eigen::Vector2d& p, const Points& outline) {
  if (contains({outline, {}}, p)) return 0;
  double nearest_m = distance_m(p, outline.back(), outline.front());
  for (std::size_t i = 1; i < outline.size(); ++i)
    nearest_m = std::min(nearest_m, distance_m(p, outline[i - 1], outline[i]));
  return nearest_m;
}

Points box_of(const WorldWall& wall) {
  const Eigen::Vector2d d = (wall.b - wall.a).normalized() * wall.thickness_m / 2, n(-d.y(), d.x());
  return {wall.a + n, wall.b + n, wall.b - n, wall.a - n};
}

/// From the robot's centre to what stands nearest: walls, objects, closed doors.
double clearance_m(const World& world, const Eigen::Vector2d& p) {
  double nearest_m = 1e9;
  for (const WorldWall& wall : world.walls) nearest_m = std::min(nearest_m, distance_m(p, box_of(wall)));
  for (const WorldObject& object : world.objects)
    nearest_m = std::min(nearest_m, distance_m(p, object.polygon));
  for (const WorldDoor& door : world.doors)
    if (!door.open) nearest_m = std::min(nearest_m, distance_m(p, door.a, door.b));
  return nearest_m;
}

double clearance_m(const World& world, const Route& route) {
  double nearest_m = 1e9;
  for (std::size_t i = 1; i < route.points.size(); ++i) {
    const Eigen::Vector2d a = route.points[i - 1], leg = route.points[i] - a;
    const int steps = 1 + static_cast<int>(leg.norm() / 0.05);
    for (int k = 0; k <= steps; ++k)
      nearest_m = std::min(nearest_m, clearance_m(world, a + leg * k / steps));
  }
  return nearest_m;
}

double length_m(const Route& route) {
  double sum_m = 0;
  for (std::size_t i = 1; i < route.points.size(); ++i)
    sum_m += (route.points[i] - route.points[i - 1]).norm();
  return sum_m;
}

}  // namespace

TEST_CASE("Routes of the shipped worlds begin at the start and keep their distance") {
  struct Promise {
    const char *world, *route;
    double length_m, clearance_m;
  };
  const Promise promises[] = {
      {"apartment", "A_safe_loop", 85, 0.46},    {"apartment", "B_rooms_tight", 101, 0.36},
      {"apartment", "C_bedroom_full", 74, 0.46}, {"apartment", "demo", 119, 0.46},
      {"compworld", "A_eight", 146, 0.46},       {"compworld", "B_rooms", 81, 0.46}};
  for (const Promise& promise : promises) {
    INFO(promise.world << " " << promise.route);
    const World world = shipped(promise.world);
    const Route& route = route_of(world, promise.route);
    CHECK(route.points.front() == world.start);
    CHECK(length_m(route) == Approx(promise.length_m).margin(1));
    CHECK(clearance_m(world, route) >= promise.clearance_m);
    const Eigen::Vector2d leg = route.points[1] - route.points[0];
    CHECK(std::atan2(leg.y(), leg.x()) == Approx(world.start_heading).margin(1e-5));
  }
}

TEST_CASE("Every shipped door lies in a gap of the walls and joins two different rooms") {
  for (const char* name : {"apartment", "compworld"}) {
    const World world = shipped(name);
    std::set<std::string> reached;
    for (const WorldDoor& door : world.doors) {
      INFO(name << " " << door.id);
      const auto rooms = rooms_joined(world, door);
      CHECK_FALSE(rooms[0].empty());
      CHECK_FALSE(rooms[1].empty());
      CHECK(rooms[0] != rooms[1]);
      reached.insert(rooms.begin(), rooms.end());
      for (const WorldWall& wall : world.walls)
        CHECK(distance_m(0.5 * (door.a + door.b), box_of(wall)) >= 0.49 * door.width_m);
    }
    CHECK(reached.size() == world.rooms.size());
  }
}

TEST_CASE("Every shipped object stands in a room and overlaps no other") {
  for (const char* name : {"apartment", "compworld"}) {
    const World world = shipped(name);
    for (std::size_t i = 0; i < world.objects.size(); ++i) {
      const MapPolygon object{world.objects[i].polygon, {}};
      INFO(name << " " << world.objects[i].id);
      double in_rooms_m2 = 0;
      for (const WorldRoom& room : world.rooms)
        in_rooms_m2 += overlap_m2(object, {room.polygon, room.holes});
      CHECK(in_rooms_m2 == Approx(area_m2(object)).margin(1e-6));
      for (std::size_t j = 0; j < i; ++j)
        CHECK(overlap_m2(object, {world.objects[j].polygon, {}}) == 0);
    }
  }
}

TEST_CASE("The apartment holds what its tests count on") {
  const World world = shipped("apartment");
  CHECK(world.doors.size() == 13);
  int cars = 0, police_cars = 0, pillars = 0;
  for (const WorldObject& object : world.objects) {
    cars += object.class_name == "car";
    police_cars += object.class_name == "police_car";
    pillars += object.class_name == "pillar";
  }
  CHECK(cars == 4);
  CHECK(police_cars == 2);
  CHECK(pillars == 6);
  for (const Person& person : world.persons) CHECK_FALSE(person.enabled);
}
