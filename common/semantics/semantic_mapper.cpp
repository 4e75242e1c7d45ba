// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/semantic_mapper.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "common/semantics/object_finder.hpp"

namespace modslam {
namespace {

/// Gives each new thing the id of the old thing it is most like, each old id once; `likeness` <= 0: not the same.
template <class Thing, class Likeness>
void keep_ids(std::vector<Thing>& now, const std::vector<Thing>& before, std::int64_t& next_id, Likeness likeness) {
  struct Pair {
    double likeness;
    std::size_t now, before;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < now.size(); ++i)
    for (std::size_t j = 0; j < before.size(); ++j)
      if (const double like = likeness(now[i], before[j]); like > 0) pairs.push_back({like, i, j});
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.likeness > b.likeness; });
  std::vector<bool> taken(before.size(), false);
  for (const Pair& pair : pairs) {
    if (now[pair.now].id != 0 || taken[pair.before]) continue;
    now[pair.now].id = before[pair.before].id;
    taken[pair.before] = true;
  }
  for (Thing& thing : now)
    if (thing.id == 0) thing.id = next_id++;
}

/// Metres of common length of two walls on nearly the same line.
double likeness_of(const Wall& p, const Wall& q) {
  const Eigen::Vector2d u = p.direction();
  if (u.dot(q.direction()) < 0.98) return 0;
  const Eigen::Vector2d mid = 0.5 * (q.a + q.b) - p.a;
  if (std::abs(u.x() * mid.y() - u.y() * mid.x()) > 0.15) return 0;
  const double from = std::max(0.0, u.dot(q.a - p.a)), to = std::min(p.length_m(), u.dot(q.b - p.a));
  return std::max(0.0, to - from);
}

double likeness_of(const Door& p, const Door& q) { return 0.5 - (p.centre() - q.centre()).norm(); }

Eigen::Vector2d mean_of(const std::vector<Eigen::Vector2d>& outline) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : outline) mean += p;
  return mean / static_cast<double>(outline.size());
}

/// Share of a grid of points over both that lies in both: intersection over union.
double outline_iou(const std::vector<Eigen::Vector2d>& p, const std::vector<Eigen::Vector2d>& q) {
  Eigen::Vector2d low = p[0], high = p[0];
  for (const auto* outline : {&p, &q})
    for (const Eigen::Vector2d& corner : *outline) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
  const double step = std::max(0.2, (high - low).maxCoeff() / 40);
  int in_both = 0, in_any = 0;
  for (double y = low.y() + 0.5 * step; y < high.y(); y += step)
    for (double x = low.x() + 0.5 * step; x < high.x(); x += step) {
      const bool a = contains(p, {x, y}), b = contains(q, {x, y});
      in_both += a && b;
      in_any += a || b;
    }
  return in_any ? static_cast<double>(in_both) / in_any : 0.0;
}

double likeness_of(const Room& p, const Room& q) {
  if (!contains(p.outline, mean_of(q.outline)) && !contains(q.outline, mean_of(p.outline)) && std::abs(p.area_m2 - q.area_m2) > 0.3 * p.area_m2)
    return 0;
  const double iou = outline_iou(p.outline, q.outline);
  return iou > 0.3 ? iou : 0.0;
}

double likeness_of(const Object& p, const Object& q) { return 0.6 - (mean_of(p.outline) - mean_of(q.outline)).norm(); }

/// Whether most of the wall's face has cells of the mask right behind it.
bool stands_on(const cv::Mat1b& mask, const Wall& wall, const KnownSpace& space) {
  int behind = 0, looked = 0;
  for (double s = 0.1; s < wall.length_m(); s += 0.1, ++looked)
    for (const double depth : {0.0, 0.1}) {
      const cv::Point c = space.cell(wall.a + s * wall.direction() - depth * wall.normal());
      if (space.inside(c) && !mask.empty() && mask(c)) {
        ++behind;
        break;
      }
    }
  return 2 * behind > looked;
}

/// Takes out of the objects what is a piece of wall between two doors, with furniture against it or without: its face goes on, in line,
/// beyond a gap no wider than a door, as a wall that stands on no object.
void drop_pieces_of_wall(ObjectMap& found, const std::vector<WallBand>& bands, const KnownSpace& space, const SemanticsConfig& config) {
  const cv::Mat1b all = found.mask.clone();
  const auto goes_on = [&](const Wall& face, const Wall& next, double gap_m) {
    return gap_m <= config.door_max_m && next.length_m() > 1.0 && face.length_m() > 1.0 && !stands_on(all, next, space);
  };
  const auto is_wall = [&](const Object& object) {
    cv::Mat1b mask(all.size(), std::uint8_t{0});
    std::vector<cv::Point> ring;
    for (const Eigen::Vector2d& p : object.outline) ring.push_back(space.cell(p));
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{ring}, cv::Scalar(255));
    for (const WallBand& band : bands)
      for (std::size_t k = 0; k + 1 < band.walls.size(); ++k) {
        const Wall &p = band.walls[k], &q = band.walls[k + 1];
        const double gap_m = (q.a - p.b).norm();
        if ((stands_on(mask, p, space) && goes_on(p, q, gap_m)) || (stands_on(mask, q, space) && goes_on(q, p, gap_m))) {
          found.mask.setTo(0, mask);
          return true;
        }
      }
    return false;
  };
  found.objects.erase(std::remove_if(found.objects.begin(), found.objects.end(), is_wall), found.objects.end());
}

}  // namespace

SemanticMapper::SemanticMapper(const SemanticsConfig& config) : config_(config), occupancy_(0.1, config.range_limit_m) {}

void SemanticMapper::clear() { *this = SemanticMapper(config_); }

void SemanticMapper::add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) {
  NodeView node{scan, sensor, {}, {}, {}, T_map_base, T_map_base};
  node.points = points_base(scan, sensor);
  node.points.erase(std::remove_if(node.points.begin(), node.points.end(), [&](const ScanPoint& p) { return p.range_m > config_.range_limit_m; }),
                    node.points.end());
  HoughOptions hough;
  hough.min_length_m = config_.line_min_m;
  node.lines = extract_lines(node.points, sensor.T_base_laser.translation(), std::abs(scan.radstep), hough);
  DoorSensorOptions doors;
  doors.min_width_m = config_.door_min_m;
  doors.max_width_m = config_.door_max_m;
  node.doors = sight_doors(scan, sensor, doors);
  draw(node, 1);
  nodes_.push_back(std::move(node));
}

void SemanticMapper::draw(const NodeView& node, int sign) {
  if (sign > 0)
    occupancy_.insert(node.scan, node.sensor, node.drawn);
  else
    occupancy_.remove(node.scan, node.sensor, node.drawn);
  for (std::size_t k = 0; k < node.points.size(); ++k) evidence_.add(node.drawn * node.points[k].p, node.lines.on_segment[k], sign);
}

void SemanticMapper::redraw(bool all) {
  const double limit_m = all ? 0.1 * config_.redraw_m : config_.redraw_m, limit_rad = all ? 0.1 * config_.redraw_rad : config_.redraw_rad;
  for (NodeView& node : nodes_) {
    if (distance(node.drawn, node.wanted) <= limit_m && std::abs(wrap_angle(node.drawn.heading - node.wanted.heading)) <= limit_rad) continue;
    draw(node, -1);
    node.drawn = node.wanted;
    draw(node, 1);
  }
}

const SemanticLayers& SemanticMapper::update(bool settled) {
  redraw(settled);
  const KnownSpace space(occupancy_);
  std::vector<PlacedSegments> scans;
  std::vector<DoorSighting> sightings;
  for (const NodeView& node : nodes_) {
    PlacedSegments placed;
    for (Segment segment : node.lines.segments) {
      segment.a = node.wanted * segment.a;
      segment.b = node.wanted * segment.b;
      placed.push_back(segment);
    }
    scans.push_back(std::move(placed));
    for (const DoorSighting& door : node.doors) sightings.push_back({node.wanted * door.a, node.wanted * door.b});
  }
  WallMapOptions wall_options;
  wall_options.min_length_m = config_.wall_min_m;
  wall_options.min_sightings = static_cast<int>(config_.wall_sightings);
  const auto is_solid = [&](const Eigen::Vector2d& p) {
    const cv::Point c = space.cell(p);
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (space.is_occupied(c + cv::Point(dx, dy))) return true;
    return false;
  };
  std::vector<WallBand> bands = merge_segments(scans, wall_options, is_solid);

  SemanticLayers layers;
  ObjectMap objects = find_objects(space, config_.object_max_m2);
  drop_pieces_of_wall(objects, bands, space, config_);
  layers.objects = objects.objects;
  for (WallBand& band : bands) {
    // The face of a thing that stands free is not a wall: what lies behind it belongs to the object.
    const auto is_face = [&](const Wall& wall) { return stands_on(objects.mask, wall, space); };
    band.walls.erase(std::remove_if(band.walls.begin(), band.walls.end(), is_face), band.walls.end());
  }
  remove_furniture(bands);
  for (WallBand& band : bands) {
    for (Wall& wall : band.walls) {
      double sum = 0;
      int count = 0;
      for (double s = 0.05; s < wall.length_m(); s += 0.1, ++count) sum += evidence_.log_odds(wall.a + s * wall.direction());
      wall.evidence = count ? sum / count : 0.0;
      layers.walls.push_back(wall);
    }
  }
  DoorMapOptions door_options;
  door_options.min_width_m = config_.door_min_m;
  door_options.max_width_m = config_.door_max_m;
  door_options.min_sightings = static_cast<int>(config_.door_sightings);
  layers.doors = find_doors(bands, sightings, space, door_options);
  RoomOptions room_options;
  room_options.min_area_m2 = config_.room_min_m2;
  room_options.min_enclosed = config_.room_enclosed;
  room_options.min_explored = config_.room_explored;
  layers.rooms = find_rooms(layers.walls, layers.doors, space, room_options);

  const auto likeness = [](const auto& p, const auto& q) { return likeness_of(p, q); };
  keep_ids(layers.walls, layers_.walls, next_wall_, likeness);
  keep_ids(layers.doors, layers_.doors, next_door_, likeness);
  keep_ids(layers.rooms, layers_.rooms, next_room_, likeness);
  keep_ids(layers.objects, layers_.objects, next_object_, likeness);
  for (Room& room : layers.rooms) room.name = (room.corridor ? "Corridor " : "Room ") + std::to_string(room.id);
  join_rooms(layers.doors, layers.rooms);
  layers_ = std::move(layers);
  return layers_;
}

}  // namespace modslam
