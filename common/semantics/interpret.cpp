// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/interpret.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "common/semantics/object_class.hpp"

namespace modslam {
namespace {

constexpr double kAtOutline_m = 0.2;  // walls lie this near the outline of their room
constexpr double kBehind_m = 0.2;     // a face hides what lies this far behind it
constexpr double kWholeFront_m = 1.2;  // a shorter front may be what a chair leaves to be seen of a longer one
constexpr double kNewsTogether_m = 1.0;  // changes this near are looked at as one

WallMapOptions wall_options(const SemanticsConfig& config) {
  WallMapOptions options;
  options.min_length_m = config.wall_min_m;
  options.min_sightings = static_cast<int>(config.wall_sightings);
  return options;
}

PartitionOptions parting_options(const SemanticsConfig& config) {
  PartitionOptions options;
  options.cuts.min_probability = config.opening_probability;
  options.cuts.slit_m = config.door_min_m;
  options.min_room_m2 = config.room_min_m2;
  return options;
}

RoomOptions room_options(const SemanticsConfig& config) {
  RoomOptions options;
  options.min_area_m2 = config.room_min_m2;
  options.min_enclosed = config.room_enclosed;
  options.min_explored = config.room_explored;
  return options;
}

/// Whether most of the wall's face has cells right behind it that `is_it` says yes to.
template <class IsIt>
bool stands_on(const Wall& wall, const KnownSpace& space, IsIt is_it) {
  int behind = 0, looked = 0;
  for (double s = 0.1; s < wall.length_m(); s += 0.1, ++looked)
    for (const double depth : {0.0, 0.1}) {
      const cv::Point c = space.cell(wall.a + s * wall.direction() - depth * wall.normal());
      if (space.inside(c) && is_it(c)) {
        ++behind;
        break;
      }
    }
  return 2 * behind > looked;
}

/// Objects that are a piece of wall between two doors, with furniture against it or without: its face goes on, in line, beyond a gap no wider than a door,
/// as a wall that stands on no object.
std::vector<bool> pieces_of_wall(const ObjectMap& found, const std::vector<const WallBand*>& bands, const KnownSpace& space, const SemanticsConfig& config) {
  std::vector<bool> pieces(found.objects.size(), false);
  const auto mark = [&](const Wall& face, const Wall& next, double gap_m) {
    if (!face.on_object || next.on_object || gap_m > config.door_max_m || next.length_m() <= 1.0 || face.length_m() <= 1.0) return;
    const cv::Rect box = grown(cv::Rect(space.cell(face.a), cv::Size(1, 1)) | cv::Rect(space.cell(face.b), cv::Size(1, 1)), 4);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const Island& island = found.objects[k].island;
      if (pieces[k] || !meet(island.box, box)) continue;
      pieces[k] = stands_on(face, space, [&](const cv::Point& c) { return island.box.contains(c) && island.mask(c - island.box.tl()); });
    }
  };
  for (const WallBand* band : bands)
    for (std::size_t k = 0; k + 1 < band->walls.size(); ++k) {
      const Wall &p = band->walls[k], &q = band->walls[k + 1];
      const double gap_m = (q.a - p.b).norm();
      mark(p, q, gap_m);
      mark(q, p, gap_m);
    }
  return pieces;
}

/// The face of a thing that stands free is not a wall: what lies behind it belongs to the object.
std::vector<Wall> without_faces(const std::vector<const WallBand*>& bands, const ObjectMap& objects, const std::vector<bool>& dropped, const KnownSpace& space) {
  const auto is_object = [&](const cv::Point& c) {
    if (!objects.mask(c)) return false;
    for (std::size_t k = 0; k < dropped.size(); ++k) {
      const Island& island = objects.objects[k].island;
      if (dropped[k] && island.box.contains(c) && island.mask(c - island.box.tl())) return false;
    }
    return true;
  };
  const bool all_stay = std::none_of(dropped.begin(), dropped.end(), [](bool one) { return one; });
  std::vector<Wall> out;
  for (const WallBand* band : bands)
    for (const Wall& wall : band->walls)
      if (!wall.on_object || (!all_stay && !stands_on(wall, space, is_object))) out.push_back(wall);
  return out;
}

/// Keeps the walls of whose places in the list `stays` says so.
template <class Stays>
void keep_those(std::vector<Wall>& walls, Stays stays) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < walls.size(); ++k)
    if (stays(k) && kept++ != k) walls[kept - 1] = walls[k];
  walls.resize(kept);
}

/// What stands before a wall, as an object.
Object at_wall(const std::array<Eigen::Vector2d, 4>& ring) {
  Object object;
  object.outline.assign(ring.begin(), ring.end());
  object.area_m2 = polygon_area_m2(object.outline);
  const double front_m = (ring[1] - ring[0]).norm();
  const ObjectClass guess = front_m < kWholeFront_m ? ObjectClass() : classify_footprint(front_m, (ring[2] - ring[1]).norm());
  object.class_name = guess.name;
  object.class_confidence = guess.confidence;
  object.evidence = 0.5;  // its back was not seen
  return object;
}

/// A door leads to rooms; a small space behind it that is none was seen through it and may be anything.
void drop_doors_to_glimpses(std::vector<Door>& doors, const Partition& partition, const std::vector<Room>& rooms, double cell_m, double glimpse_m2) {
  std::set<int> doubtful = glimpses(partition, cell_m, glimpse_m2);
  for (const Room& room : rooms) doubtful.erase(room.region);
  const auto leads_there = [&](const Door& door) { return doubtful.count(door.region_a) + doubtful.count(door.region_b) > 0; };
  doors.erase(std::remove_if(doors.begin(), doors.end(), leads_there), doors.end());
}

}  // namespace

Interpreter::Interpreter(const SemanticsConfig& config, OpeningModel::Kind kind)
    : config_(config), walls_(wall_options(config)), openings_(config.opening_max_m, OpeningModel(config.opening_trees, kind)), parter_(parting_options(config)),
      rooms_(room_options(config)) {}

/// What is kept in cells moves with the raster's corner when that grows; nothing else is new by it.
void Interpreter::follow(const KnownSpace& space) {
  const Growth growth{frame_.tl() - space.corner, space.occupancy.size()};
  const bool grew = frame_.area() > 0 && frame_ != space.frame();
  frame_ = space.frame();
  if (!grew) return;
  floor_.grow(growth);
  objects_.grow(growth);
  openings_.grow(growth);
  parter_.grow(growth);
  rooms_.grow(growth);
  hidden_ = grown(hidden_, growth, 0);
  for (auto& [region, ring] : known_rings_) ring.box += growth.shift;
}

Interpreter::Bands Interpreter::find_bands(const KnownSpace& space, const Boxes& changed, const LogOdds& wall_log_odds, Boxes odds_changed) {
  const cv::Rect frame({0, 0}, space.occupancy.size());
  const auto is_solid = [&](const Eigen::Vector2d& p) {
    const cv::Rect near = grown(cv::Rect(space.cell(p), cv::Size(1, 1)), 2) & frame;
    for (int y = near.y; y < near.br().y; ++y) {
      const std::uint8_t* row = space.occupancy[y];
      for (int x = near.x; x < near.br().x; ++x)
        if (row[x] >= 128) return true;
    }
    return false;
  };
  const auto finish = [&](Wall& wall) {
    double sum = 0;
    int count = 0;
    for (double s = 0.05; s < wall.length_m(); s += 0.1, ++count) sum += wall_log_odds(wall.a + s * wall.direction());
    wall.evidence = count ? sum / count : 0.0;
    wall.on_object = stands_on(wall, space, [&](const cv::Point& c) { return objects_.mask(c) > 0; });
  };
  for (const cv::Rect& box : changed)
    odds_changed.push_back(plan_box(space.place(box.x, box.y), space.place(box.br().x, box.br().y), 0));
  return walls_.update(is_solid, finish, odds_changed);
}

std::vector<bool> Interpreter::find_furniture(const std::vector<Wall>& faces, const KnownSpace& space, const Boxes& changed) {
  std::vector<PlanBox> boxes;
  const double cell_m = space.resolution_m;
  for (const cv::Rect& box : windows(changed, static_cast<int>(kNewsTogether_m / cell_m), space.occupancy.size()))
    boxes.push_back({space.place(box.x, box.y), space.place(box.br().x, box.br().y)});
  return furniture_.update(faces, [&](const Eigen::Vector2d& p) { return space.is_free(space.cell(p)); }, boxes);
}

/// @return where walls came and went.
Boxes Interpreter::take_walls(const std::vector<Wall>& walls, const KnownSpace& space, WallSet::News& news) {
  news = known_walls_.update(walls);
  Boxes boxes;
  for (const std::vector<std::size_t>* numbers : {&news.gone, &news.come})
    for (const std::size_t k : *numbers) {
      const Wall& wall = known_walls_[k];
      boxes.push_back(grown(cv::Rect(space.cell(wall.a), cv::Size(1, 1)) | cv::Rect(space.cell(wall.b), cv::Size(1, 1)), static_cast<int>(0.3 / space.resolution_m)));
    }
  return boxes;
}

/// Draws what is inside rooms, off their outlines, and no floor. @return where that changed.
Boxes Interpreter::find_hidden(const std::vector<Room>& rooms, const KnownSpace& space, const Boxes& open) {
  Boxes changed;
  if (hidden_.size() != space.occupancy.size()) {
    hidden_ = cv::Mat1b(space.occupancy.size(), std::uint8_t{0});
    known_rings_.clear();
    changed.emplace_back(cv::Point(0, 0), hidden_.size());
  }
  const int thick = 2 * static_cast<int>(std::lround(kAtOutline_m / space.resolution_m)) + 1;
  const auto ring_of = [&](const std::vector<Eigen::Vector2d>& outline, const cv::Point& corner) {
    std::vector<cv::Point> ring;
    for (const Eigen::Vector2d& p : outline) ring.push_back(space.cell(p) - corner);
    return ring;
  };
  Boxes stirred = open;
  for (auto& [region, ring] : known_rings_) ring.stays = false;
  for (const Room& room : rooms) {
    Ring& ring = known_rings_[room.region];
    ring.stays = true;
    if (ring.outline == room.outline) continue;
    stirred.push_back(ring.box);
    ring = {room.outline, grown(cv::boundingRect(ring_of(room.outline, {0, 0})), thick)};
    stirred.push_back(ring.box);
  }
  for (auto known = known_rings_.begin(); known != known_rings_.end();) {
    if (!known->second.stays) stirred.push_back(known->second.box);
    known = known->second.stays ? std::next(known) : known_rings_.erase(known);
  }
  for (const cv::Rect& box : windows(stirred, 0, hidden_.size())) {
    cv::Mat1b part(box.size(), std::uint8_t{0});
    std::vector<std::vector<cv::Point>> near;
    for (const auto& [region, ring] : known_rings_) {
      if (!meet(ring.box, box)) continue;
      near.push_back(ring_of(ring.outline, box.tl()));
      cv::fillPoly(part, std::vector<std::vector<cv::Point>>{near.back()}, cv::Scalar(255));
    }
    cv::polylines(part, near, true, cv::Scalar(0), thick);
    part.setTo(0, floor_.open(box));
    take_over(hidden_, box, part, changed);
  }
  return changed;
}

/// Faces that stand in a room, off its outline, with what nobody saw behind them, belong to what is in the room: parked cars, beds, counters.
void Interpreter::drop_faces_in_rooms(SemanticLayers& layers, const KnownSpace& space, const Boxes& open, const WallSet::News& news) {
  const auto hides = [&](const Wall& wall) {
    if (wall.length_m() > kLongestFront_m) return false;
    const Eigen::Vector2d u = wall.direction(), from = wall.a - kBehind_m * wall.normal();
    int behind = 0, looked = 0;
    for (double s = 0.1, length_m = wall.length_m(); s < length_m; s += 0.1, ++looked) {
      const cv::Point c = space.cell(from + s * u);
      behind += space.inside(c) && hidden_(c);
    }
    return 2 * behind > looked;
  };
  std::vector<std::size_t> stirred = news.come;
  for (const cv::Rect& box : find_hidden(layers.rooms, space, open)) {
    const double cell_m = space.resolution_m;
    const auto near = known_walls_.near(space.place(box.x, box.y), space.place(box.br().x, box.br().y), kBehind_m + cell_m);
    stirred.insert(stirred.end(), near.begin(), near.end());
  }
  hides_.resize(known_walls_.end(), false);
  std::sort(stirred.begin(), stirred.end());
  stirred.erase(std::unique(stirred.begin(), stirred.end()), stirred.end());
  for (const std::size_t k : stirred) hides_[k] = hides(known_walls_[k]);
  keep_those(layers.walls, [&](std::size_t k) { return !hides_[known_walls_.numbers()[k]]; });
}

SemanticLayers Interpreter::update(const KnownSpace& space, const Boxes& changed, const LogOdds& wall_log_odds, const Boxes& odds_changed) {
  SemanticLayers layers;
  if (space.empty()) return layers;
  follow(space);
  const FloorChange floor = update_floor(floor_, space, config_.object_max_m2, changed);
  Boxes stirred = update_objects(objects_, space, floor_, changed, floor.islands);
  stirred.insert(stirred.end(), changed.begin(), changed.end());
  const Bands bands = find_bands(space, stirred, wall_log_odds, odds_changed);
  const std::vector<bool> dropped = pieces_of_wall(objects_, bands, space, config_);
  for (std::size_t k = 0; k < dropped.size(); ++k)
    if (!dropped[k]) layers.objects.push_back(objects_.objects[k].object);
  layers.walls = without_faces(bands, objects_, dropped, space);
  const std::vector<bool> furniture = find_furniture(layers.walls, space, changed);
  keep_those(layers.walls, [&](std::size_t k) { return !furniture[k]; });
  const auto is_free = [&](const Eigen::Vector2d& p) { return space.is_free(space.cell(p)); };
  for (const auto& ring : furniture_.footprints(is_free)) layers.objects.push_back(at_wall(ring));

  WallSet::News news;
  const Boxes walls = take_walls(layers.walls, space, news);
  wall_ends_.update(layers.walls, known_walls_, news.come, space, changed);
  openings_.update(floor_, space, known_walls_, floor, walls);
  Boxes parted = parter_.update(floor_, space, known_walls_, openings_.take_news(parting_options(config_).cuts), floor.open, walls);
  DoorMapOptions doors;
  doors.min_width_m = config_.door_min_m;
  doors.max_width_m = config_.door_max_m;
  layers.doors = find_doors(parter_.partition(), sightings_, doors);
  parted.insert(parted.end(), changed.begin(), changed.end());
  layers.rooms = rooms_.update(parter_.partition(), floor_, space, parted);
  drop_doors_to_glimpses(layers.doors, parter_.partition(), layers.rooms, space.resolution_m, room_options(config_).glimpse_m2);
  drop_faces_in_rooms(layers, space, floor.open, news);
  return layers;
}

}  // namespace modslam
