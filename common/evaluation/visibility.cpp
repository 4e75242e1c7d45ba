// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/visibility.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kCell_m = 0.1;
constexpr int kTile = 64;  // cells along a side
constexpr double kTouch_m = 0.1;

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

double cross(const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
  return u.x() * v.y() - u.y() * v.x();
}

bool segments_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 &&
         cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

int floor_div(int value, int by) { return value >= 0 ? value / by : -((-value + by - 1) / by); }
int cell_of(double metres) { return static_cast<int>(std::floor(metres / kCell_m)); }

/// Wall samples in buckets, so that a beam's end finds those near it.
class SampleIndex {
 public:
  SampleIndex(const std::vector<WallSample>& samples, const std::vector<MapWall>& walls) {
    double reach_m = kTouch_m;
    for (const MapWall& wall : walls) reach_m = std::max(reach_m, kTouch_m + wall.thickness_m / 2);
    bucket_m_ = reach_m + 0.05;
    for (std::size_t i = 0; i < samples.size(); ++i) buckets_[key(samples[i].p)].push_back(i);
  }
  template <class Visit>
  void near(const Eigen::Vector2d& p, Visit&& visit) const {
    const auto [x, y] = key(p);
    for (int i = x - 1; i <= x + 1; ++i)
      for (int j = y - 1; j <= y + 1; ++j)
        if (const auto found = buckets_.find({i, j}); found != buckets_.end())
          for (const std::size_t sample : found->second) visit(sample);
  }

 private:
  std::pair<int, int> key(const Eigen::Vector2d& p) const {
    return {static_cast<int>(std::floor(p.x() / bucket_m_)),
            static_cast<int>(std::floor(p.y() / bucket_m_))};
  }
  double bucket_m_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> buckets_;
};

/// Follows the beams of a run through the true world.
class Observer {
 public:
  explicit Observer(const SemanticMap& truth)
      : truth_(truth), samples_(sample_walls(truth.walls)), index_(samples_, truth.walls) {
    result.wall_samples.assign(samples_.size(), false);
    crossed_.assign(truth.doors.size(), false);
    jamb_a_ = jamb_b_ = crossed_;
    result.from_run = true;
  }

  void add(const PlacedScan& placed) {
    for (std::size_t i = 0; i < placed.scan.ranges_m.size(); ++i) {
      const bool hit = is_return(placed.scan.ranges_m[i], placed.sensor);
      if (!hit && !placed.sensor.no_return_is_free) continue;
      const double reach_m = hit ? placed.scan.ranges_m[i] : placed.sensor.range_max_m;
      const double bearing_rad = placed.scan.bearing_rad(i);
      const Eigen::Vector2d end =
          placed.T_world_laser *
          Eigen::Vector2d(reach_m * std::cos(bearing_rad), reach_m * std::sin(bearing_rad));
      add_beam(placed.T_world_laser.translation(), end, hit);
    }
  }

  Visibility finish() {
    for (std::size_t d = 0; d < crossed_.size(); ++d)
      result.doors.push_back(crossed_[d] || (jamb_a_[d] && jamb_b_[d]));
    for (const MapRoom& room : truth_.rooms)
      result.rooms_explored.push_back(result.seen.share(room.polygon, truth_.objects));
    return std::move(result);
  }

 private:
  void add_beam(const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool hit) {
    result.seen.add_beam(from, to);
    for (std::size_t d = 0; d < crossed_.size(); ++d) {
      const MapDoor& door = truth_.doors[d];
      if (!crossed_[d]) crossed_[d] = segments_cross(from, to, door.a, door.b);
      if (hit && (to - door.a).norm() <= kTouch_m) jamb_a_[d] = true;
      if (hit && (to - door.b).norm() <= kTouch_m) jamb_b_[d] = true;
    }
    if (!hit) return;
    index_.near(to, [&](std::size_t i) {
      const WallSample& sample = samples_[i];
      if (result.wall_samples[i]) return;
      const double half_m = truth_.walls[sample.wall].thickness_m / 2;
      if ((to - sample.p).norm() <= kTouch_m + half_m &&
          distance_to_wall(to, truth_.walls[sample.wall]) <= kTouch_m)
        result.wall_samples[i] = true;
    });
  }

  Visibility result;
  const SemanticMap& truth_;
  std::vector<WallSample> samples_;
  SampleIndex index_;
  std::vector<bool> crossed_, jamb_a_, jamb_b_;
};

}  // namespace

std::vector<WallSample> sample_walls(const std::vector<MapWall>& walls) {
  constexpr double kEvery_m = 0.05;
  std::vector<WallSample> samples;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const double length_m = (walls[w].b - walls[w].a).norm();
    const int pieces = static_cast<int>(std::ceil(length_m / kEvery_m - 1e-9));
    for (int i = 0; i < pieces; ++i)
      samples.push_back(
          {walls[w].a + (i + 0.5) / pieces * (walls[w].b - walls[w].a), w, length_m / pieces});
  }
  return samples;
}

double distance_to_wall(const Eigen::Vector2d& point, const MapWall& wall) {
  const Eigen::Vector2d ab = wall.b - wall.a;
  if (wall.thickness_m <= 0 || ab.norm() == 0) return distance_to_segment(point, wall.a, wall.b);
  const Eigen::Vector2d to_face =
      Eigen::Vector2d(-ab.y(), ab.x()).normalized() * (wall.thickness_m / 2);
  return std::min(distance_to_segment(point, wall.a + to_face, wall.b + to_face),
                  distance_to_segment(point, wall.a - to_face, wall.b - to_face));
}

// Steps of half a cell touch every cell that the beam crosses by more than half a cell.
void SeenSpace::add_beam(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double length_m = (to - from).norm();
  if (!(length_m < 1000)) return;
  const int steps = static_cast<int>(length_m / (kCell_m / 2)) + 1;
  std::pair<int, int> tile_key{};
  std::vector<bool>* tile = nullptr;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d p = from + (to - from) * (static_cast<double>(i) / steps);
    const int x = cell_of(p.x()), y = cell_of(p.y());
    const std::pair<int, int> key{floor_div(x, kTile), floor_div(y, kTile)};
    if (!tile || key != tile_key) {
      tile = &tiles_[key];
      tile->resize(kTile * kTile);
      tile_key = key;
    }
    (*tile)[(y - key.second * kTile) * kTile + (x - key.first * kTile)] = true;
  }
}

double SeenSpace::share(const MapPolygon& polygon, const std::vector<MapObject>& objects) const {
  Eigen::Vector2d low = polygon.outline.front(), high = low;
  for (const Eigen::Vector2d& p : polygon.outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
  // Cell by cell, or at a million places of a region that no building has.
  const double step_m = std::max(kCell_m, std::sqrt((high - low).prod() / 1e6));
  std::int64_t places = 0, seen = 0;
  for (double y = (cell_of(low.y()) + 0.5) * kCell_m; y < high.y(); y += step_m)
    for (double x = (cell_of(low.x()) + 0.5) * kCell_m; x < high.x(); x += step_m) {
      const Eigen::Vector2d place(x, y);
      if (!contains(polygon, place)) continue;
      const auto holds_it = [&](const MapObject& object) { return contains(object.polygon, place); };
      if (std::any_of(objects.begin(), objects.end(), holds_it)) continue;
      ++places;
      seen += crossed(place);
    }
  return places ? static_cast<double>(seen) / static_cast<double>(places) : 0.0;
}

bool SeenSpace::crossed(const Eigen::Vector2d& place) const {
  const int x = cell_of(place.x()), y = cell_of(place.y());
  const auto tile = tiles_.find({floor_div(x, kTile), floor_div(y, kTile)});
  return tile != tiles_.end() &&
         tile->second[(y - tile->first.second * kTile) * kTile + (x - tile->first.first * kTile)];
}

Visibility everything_visible(const SemanticMap& truth) {
  Visibility all;
  all.wall_samples.assign(sample_walls(truth.walls).size(), true);
  all.doors.assign(truth.doors.size(), true);
  all.rooms_explored.assign(truth.rooms.size(), 1.0);
  return all;
}

Visibility visible_in(const SemanticMap& truth, const std::vector<PlacedScan>& scans) {
  Observer observer(truth);
  for (const PlacedScan& placed : scans) observer.add(placed);
  return observer.finish();
}

}  // namespace modslam
