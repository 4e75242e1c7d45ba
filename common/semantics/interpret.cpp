// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/interpret.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/semantics/object_class.hpp"

namespace modslam {
namespace {

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

/// Around walls that came and went.
Boxes boxes_of(const NumberNews& news, const WallSet& walls, const KnownSpace& space) {
  Boxes boxes;
  for (const Numbers* numbers : {&news.gone, &news.come})
    for (const std::size_t k : *numbers)
      boxes.push_back(grown(cv::Rect(space.cell(walls[k].a), cv::Size(1, 1)) | cv::Rect(space.cell(walls[k].b), cv::Size(1, 1)), static_cast<int>(0.3 / space.resolution_m)));
  return boxes;
}

/// What stands before a wall, as an object.
Object at_wall(const std::array<Eigen::Vector2d, 4>& ring) {
  Object object;
  object.outline = Corners::Points(ring.begin(), ring.end());
  object.area_m2 = polygon_area_m2(object.outline);
  const double front_m = (ring[1] - ring[0]).norm();
  const ObjectClass guess = front_m < kWholeFront_m ? ObjectClass() : classify_footprint(front_m, (ring[2] - ring[1]).norm());
  object.class_name = guess.name;
  object.class_confidence = guess.confidence;
  object.evidence = 0.5;  // its back was not seen
  return object;
}

/// A door leads to rooms; a small space behind it that is none was seen through it and may be anything.
void drop_doors_to_glimpses(std::vector<Door>& doors, const Partition& partition, const RoomMap& rooms, double cell_m, double glimpse_m2) {
  const auto is_doubtful = [&](int number) {
    const FloorRegion* region = partition.find(number);
    return region && region->is_glimpse(cell_m, glimpse_m2) && !rooms.is_room(number);
  };
  const auto leads_there = [&](const Door& door) { return is_doubtful(door.region_a) || is_doubtful(door.region_b); };
  doors.erase(std::remove_if(doors.begin(), doors.end(), leads_there), doors.end());
}

}  // namespace

Interpreter::Interpreter(const SemanticsConfig& config, OpeningModel::Kind kind)
    : config_(config), found_walls_(wall_options(config)), openings_(config.opening_max_m, OpeningModel(config.opening_trees, kind)), parter_(parting_options(config)),
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
  hidden_.grow(growth);
}

WallMap::News Interpreter::find_walls(const KnownSpace& space, const Boxes& changed, const LogOdds& wall_log_odds, Boxes odds_changed) {
  const cv::Rect frame({0, 0}, space.occupancy.size());
  const auto is_solid = [&](const Eigen::Vector2d& p) {
    const cv::Point c = space.cell(p);
    if (frame.contains(c) && space.occupancy(c) >= 128) return true;  // as most are
    const cv::Rect near = grown(cv::Rect(c, cv::Size(1, 1)), 2) & frame;
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
  WallMap::News news = found_walls_.update(is_solid, finish, odds_changed);
  for (const std::size_t k : news.gone) on_objects_.erase(k);
  for (const Numbers* numbers : {&news.come, &news.altered})
    for (const std::size_t k : *numbers) {
      if (found_walls_.walls()[k].on_object) on_objects_.insert(k);
      else on_objects_.erase(k);
    }
  return news;
}

/// Objects that are a piece of wall between two doors, with furniture against it or without: its face goes on, in line, beyond a gap no wider than a door,
/// as a wall that stands on no object.
std::vector<bool> Interpreter::pieces_of_wall(const KnownSpace& space) const {
  std::vector<bool> pieces(objects_.objects.size(), false);
  for (const std::size_t number : on_objects_) {
    const Wall& face = found_walls_.walls()[number];
    const WallMap::Neighbours& beside = found_walls_.beside(number);
    const auto goes_on = [&](std::size_t next, bool after) {
      if (next == WallMap::kNone) return false;
      const Wall& wall = found_walls_.walls()[next];
      return !wall.on_object && wall.length_m() > 1.0 && (after ? wall.a - face.b : face.a - wall.b).norm() <= config_.door_max_m;
    };
    if (face.length_m() <= 1.0 || !(goes_on(beside.before, false) || goes_on(beside.after, true))) continue;
    const cv::Rect box = grown(cv::Rect(space.cell(face.a), cv::Size(1, 1)) | cv::Rect(space.cell(face.b), cv::Size(1, 1)), 4);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const Island& island = objects_.objects[k].island;
      if (pieces[k] || !meet(island.box, box)) continue;
      pieces[k] = stands_on(face, space, [&](const cv::Point& c) { return island.box.contains(c) && island.mask(c - island.box.tl()); });
    }
  }
  return pieces;
}

/// The face of a thing that stands free is not a wall: what lies behind it belongs to the object. @return news of the others.
NumberNews Interpreter::take_faces(const WallMap::News& found, const std::vector<bool>& dropped, const KnownSpace& space) {
  const auto is_object = [&](const cv::Point& c) {
    if (!objects_.mask(c)) return false;
    for (std::size_t k = 0; k < dropped.size(); ++k) {
      const Island& island = objects_.objects[k].island;
      if (dropped[k] && island.box.contains(c) && island.mask(c - island.box.tl())) return false;
    }
    return true;
  };
  const bool pieces_stand = std::any_of(dropped.begin(), dropped.end(), [](bool one) { return one; });
  const bool pieces_stood = std::exchange(pieces_stood_, pieces_stand);
  const Numbers on_objects = pieces_stand || pieces_stood ? Numbers(on_objects_.begin(), on_objects_.end()) : Numbers();
  const std::set<std::size_t> gone(found.gone.begin(), found.gone.end());
  const auto is_face = [&](std::size_t k) {
    const Wall& wall = found_walls_.walls()[k];
    return !gone.count(k) && (!wall.on_object || (pieces_stand && !stands_on(wall, space, is_object)));
  };
  return news_among(together({&found.gone, &found.come, &found.altered, &on_objects}), [&](std::size_t k) { return furniture_.walls().has(k); }, is_face);
}

/// Of the faces, those that are no furniture. @return what came and went.
NumberNews Interpreter::take_walls(const NumberNews& faces, const KnownSpace& space, const Boxes& changed) {
  std::vector<PlanBox> boxes;
  for (const cv::Rect& box : windows(changed, static_cast<int>(kNewsTogether_m / space.resolution_m), space.occupancy.size()))
    boxes.push_back({space.place(box.x, box.y), space.place(box.br().x, box.br().y)});
  const auto is_free = [&](const Eigen::Vector2d& p) { return space.is_free(space.cell(p)); };
  const Numbers touched = furniture_.update(faces, found_walls_.walls(), is_free, boxes);
  const auto is_wall = [&](std::size_t k) { return furniture_.walls().has(k) && !furniture_.is_furniture(k); };
  const NumberNews news = news_among(together({&touched, &faces.gone, &faces.come}), [&](std::size_t k) { return known_walls_.has(k); }, is_wall);
  known_walls_.take(news, found_walls_.walls());
  return news;
}

/// Faces that stand in a room, off its outline, with what nobody saw behind them, belong to what is in the room: parked cars, beds, counters.
/// @return numbers of walls that were asked whether they are such.
Numbers Interpreter::find_hiding(const KnownSpace& space, const Boxes& open, const NumberNews& news) {
  const auto hides = [&](const Wall& wall) {
    if (wall.length_m() > kLongestFront_m) return false;
    const Eigen::Vector2d u = wall.direction(), from = wall.a - kBehind_m * wall.normal();
    int behind = 0, looked = 0;
    for (double s = 0.1, length_m = wall.length_m(); s < length_m; s += 0.1, ++looked) {
      const cv::Point c = space.cell(from + s * u);
      behind += space.inside(c) && hidden_.contains(c);
    }
    return 2 * behind > looked;
  };
  Numbers stirred = news.come;
  for (const cv::Rect& box : hidden_.update(rooms_.news(), space, floor_, open)) {
    const double cell_m = space.resolution_m;
    const Numbers near = known_walls_.near(space.place(box.x, box.y), space.place(box.br().x, box.br().y), kBehind_m + cell_m);
    stirred.insert(stirred.end(), near.begin(), near.end());
  }
  hides_.resize(known_walls_.end(), false);
  tidy(stirred);
  for (const std::size_t k : stirred) hides_[k] = hides(known_walls_[k]);
  return stirred;
}

/// Lists the walls that hide nothing. @return those that went.
std::vector<Wall> Interpreter::list_walls(const Numbers& doubtful, const Numbers& altered, const KnownSpace& space, std::vector<Wall>& walls) {
  const NumberNews news = news_among(doubtful, [&](std::size_t k) { return list_.has(k); }, [&](std::size_t k) { return known_walls_.has(k) && !hides_[k]; });
  return list_.update(walls, news, altered, [&](std::size_t k) {
    Wall wall = found_walls_.walls()[k];
    wall_ends_.fill_in(k, wall, space);
    return wall;
  });
}

std::vector<Wall> Interpreter::update(const KnownSpace& space, const Boxes& changed, const LogOdds& wall_log_odds, const Boxes& odds_changed, SemanticLayers& layers) {
  if (space.empty()) return {};
  follow(space);
  const FloorChange floor = update_floor(floor_, space, config_.object_max_m2, changed);
  Boxes stirred = update_objects(objects_, space, floor_, changed, floor.islands);
  stirred.insert(stirred.end(), changed.begin(), changed.end());
  const WallMap::News found = find_walls(space, stirred, wall_log_odds, odds_changed);
  const std::vector<bool> dropped = pieces_of_wall(space);
  layers.objects.clear();
  for (std::size_t k = 0; k < dropped.size(); ++k)
    if (!dropped[k]) layers.objects.push_back(objects_.objects[k].object);
  const NumberNews news = take_walls(take_faces(found, dropped, space), space, changed);
  const auto is_free = [&](const Eigen::Vector2d& p) { return space.is_free(space.cell(p)); };
  for (const auto& ring : furniture_.footprints(is_free)) layers.objects.push_back(at_wall(ring));

  const Boxes walls = boxes_of(news, known_walls_, space);
  const Numbers ends = wall_ends_.update(known_walls_, news.come, space, changed);
  openings_.update(floor_, space, known_walls_, floor, walls);
  Boxes parted = parter_.update(floor_, space, known_walls_, openings_.take_news(parting_options(config_).cuts), floor.open, walls);
  DoorMapOptions doors;
  doors.min_width_m = config_.door_min_m;
  doors.max_width_m = config_.door_max_m;
  layers.doors = find_doors(parter_.partition(), sightings_, doors);
  parted.insert(parted.end(), changed.begin(), changed.end());
  layers.rooms = rooms_.update(parter_.partition(), floor_, space, parted);
  drop_doors_to_glimpses(layers.doors, parter_.partition(), rooms_, space.resolution_m, room_options(config_).glimpse_m2);
  const Numbers asked = find_hiding(space, floor.open, news);
  return list_walls(together({&news.gone, &news.come, &asked}), together({&found.altered, &ends}), space, layers.walls);
}

}  // namespace modslam
