// SPDX-License-Identifier: BSD-3-Clause
/// @file A drawn world: what the simulated robot drives through and what its semantic map is scored
/// on.
///
/// A world file is GeoJSON, a FeatureCollection in metres (x right, y up), one feature a line; each
/// feature's `properties.kind` says what it is (config/worlds/*.geojson are examples):
///   wall    LineString, its middle line    id, thickness (all in metres)
///   door    LineString, jamb to jamb       id, width, state open|closed; lies in a gap of the
///   walls room    Polygon, inner faces           id, category, name; category "corridor" is a
///   corridor object  Polygon                        id, class route   LineString id, speed [m/s],
///   corner_radius [m], turn smooth|in_place person  LineString, walked to and fro  id, radius [m],
///   speed [m/s], enabled start   Point, exactly one             heading [rad]
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

namespace modslam {

/// A straight wall: a box of `thickness_m` round the middle line a-b, square at both ends, so that
/// the ends of a cut wall are the jambs of its doorways.
struct WorldWall {
  std::string id;
  Eigen::Vector2d a, b;
  double thickness_m = 0;
};

/// A doorway, jamb to jamb. A closed door stands in the way like a thin wall from a to b.
struct WorldDoor {
  std::string id;
  Eigen::Vector2d a, b;
  double width_m = 0;
  bool open = true;
};

/// A room or a corridor; rings are open (first point not repeated), 3 points or more.
struct WorldRoom {
  std::string id, category, name;
  std::vector<Eigen::Vector2d> polygon;
  std::vector<std::vector<Eigen::Vector2d>> holes;  ///< the block a ring corridor runs round
};

/// Furniture, a car, a pillar: solid, its edges are what the laser sees.
struct WorldObject {
  std::string id, class_name;
  std::vector<Eigen::Vector2d> polygon;  ///< open, 3 points or more
};

/// A tour for the robot: corners are rounded with `corner_radius_m` or turned in place.
struct Route {
  std::string id;
  std::vector<Eigen::Vector2d> points;  ///< 2 or more, no two neighbours equal
  double speed_mps = 0, corner_radius_m = 0;
  bool turn_in_place = false;
};

/// Someone who walks to and fro on a line: a moving circle.
struct Person {
  std::string id;
  std::vector<Eigen::Vector2d> points;
  double radius_m = 0, speed_mps = 0;
  bool enabled = false;
};

struct World {
  std::string name;  ///< of the file, for messages
  std::vector<WorldWall> walls;
  std::vector<WorldDoor> doors;
  std::vector<WorldRoom> rooms;
  std::vector<WorldObject> objects;
  std::vector<Route> routes;
  std::vector<Person> persons;
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  double start_heading = 0;  ///< radians, counter-clockwise from x
};

/// Reads a world from the text of its file; `name` is used in errors only.
/// @throws std::invalid_argument naming file, feature number (from 1) and what is wrong with it:
///   no JSON, an unknown kind, a missing, wrong or out-of-range property, a non-finite coordinate,
///   too few points, an id used twice, not exactly one start.
World parse_world(const std::string& text, const std::string& name);

/// Reads a world file. @throws std::runtime_error if unreadable, else as parse_world.
World load_world(const std::string& path);

/// The route called `id`. @throws std::invalid_argument listing the routes there are.
const Route& route_of(const World& world, const std::string& id);

/// The route driven `laps` times: there, back, there again.
Route to_and_fro(Route route, std::int64_t laps);

}  // namespace modslam
