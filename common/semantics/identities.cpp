// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/identities.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "common/semantics/plan_index.hpp"
#include "common/semantics/room_events.hpp"
#include "common/semantics/room_finder.hpp"

namespace modslam {
namespace {

constexpr double kSquare_m = 3.2, kReach_m = 0.6;  // things farther apart are not the same

struct Box {
  Eigen::Vector2d low{1e300, 1e300}, high{-1e300, -1e300};
  explicit Box(const std::vector<Eigen::Vector2d>& outline) {
    for (const Eigen::Vector2d& p : outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  double area() const { return std::max(0.0, high.x() - low.x()) * std::max(0.0, high.y() - low.y()); }
};

Box box_of(const Wall& wall) { return Box({wall.a, wall.b}); }
Box box_of(const Door& door) { return Box({door.a, door.b}); }
Box box_of(const Room& room) { return Box(room.outline); }
Box box_of(const Object& object) { return Box(object.outline); }

bool is_same(const Wall& p, const Wall& q) { return p.a == q.a && p.b == q.b; }
bool is_same(const Door& p, const Door& q) { return p.a == q.a && p.b == q.b; }
bool is_same(const Room& p, const Room& q) { return p.outline == q.outline; }
bool is_same(const Object& p, const Object& q) { return p.outline == q.outline; }

/// What has its id already stands before what has none.
template <class Thing>
std::size_t first_new(const std::vector<Thing>& things) {
  std::size_t first = things.size();
  while (first > 0 && things[first - 1].id == 0) --first;
  return first;
}

/// What lies just where it lay is the same. Lists change little from one update to the next: most things follow the one that they followed before, and only
/// of the others an index is made.
template <class Thing>
void keep_same(std::vector<Thing>& now, const std::vector<Thing>& before, std::vector<bool>& taken) {
  constexpr std::size_t kLookAhead = 12;
  const auto keep = [&](Thing& thing, std::size_t j) {
    if (taken[j] || !is_same(thing, before[j])) return false;
    thing.id = before[j].id;
    taken[j] = true;
    return true;
  };
  std::size_t expected = 0;
  std::vector<Thing*> others;
  for (std::size_t i = first_new(now); i < now.size(); ++i) {
    Thing& thing = now[i];
    const std::size_t end = std::min(before.size(), expected + kLookAhead);
    std::size_t j = expected;
    while (j < end && !keep(thing, j)) ++j;
    if (j < end) expected = j + 1;
    else others.push_back(&thing);
  }
  if (others.empty()) return;
  const auto place_of = [](const Thing& thing) {
    const Box box = box_of(thing);
    return std::array<double, 4>{box.low.x(), box.low.y(), box.high.x(), box.high.y()};
  };
  std::map<std::array<double, 4>, std::size_t> places;
  for (std::size_t j = 0; j < before.size(); ++j)
    if (!taken[j]) places.emplace(place_of(before[j]), j);
  for (Thing* thing : others)
    if (const auto found = places.find(place_of(*thing)); found != places.end()) keep(*thing, found->second);
}

/// Gives each new thing the id of the old thing it is most like, each old id once; `likeness` <= 0: not the same.
template <class Thing, class Likeness>
void keep_ids(std::vector<Thing>& now, const std::vector<Thing>& before, std::int64_t& next_id, Likeness likeness) {
  struct Pair {
    double likeness;
    std::size_t now, before;
  };
  std::vector<Pair> pairs;
  std::vector<bool> taken(before.size(), false);
  const std::size_t first = first_new(now);
  keep_same(now, before, taken);
  PlanIndex index(kSquare_m);
  for (std::size_t j = 0; j < before.size(); ++j) {
    if (taken[j]) continue;
    const Box box = box_of(before[j]);
    index.add(box.low, box.high, j);
  }
  for (std::size_t i = first; i < now.size(); ++i) {
    if (now[i].id != 0) continue;
    const Box box = box_of(now[i]);
    for (const std::size_t j : index.near(box.low, box.high, kReach_m))
      if (const double like = likeness(now[i], before[j]); like > 0) pairs.push_back({like, i, j});
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.likeness > b.likeness; });
  for (const Pair& pair : pairs) {
    if (now[pair.now].id != 0 || taken[pair.before]) continue;
    now[pair.now].id = before[pair.before].id;
    taken[pair.before] = true;
  }
  for (std::size_t i = first; i < now.size(); ++i)
    if (now[i].id == 0) now[i].id = next_id++;
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

/// Intersection over union of the boxes around both: outlines far apart need no closer look.
double box_iou(const Box& p, const Box& q) {
  Box both = p;
  both.low = p.low.cwiseMax(q.low);
  both.high = p.high.cwiseMin(q.high);
  const double common = (both.high.array() > both.low.array()).all() ? both.area() : 0.0;
  return common > 0 ? common / (p.area() + q.area() - common) : 0.0;
}

double likeness_of(const Room& p, const Room& q) {
  if (box_iou(Box(p.outline), Box(q.outline)) < 0.1) return 0;
  if (p.outline == q.outline) return 1;
  if (!contains(p.outline, mean_of(q.outline)) && !contains(q.outline, mean_of(p.outline)) && std::abs(p.area_m2 - q.area_m2) > 0.3 * p.area_m2)
    return 0;
  const double iou = outline_iou(p.outline, q.outline);
  return iou > 0.3 ? iou : 0.0;
}

double likeness_of(const Object& p, const Object& q) { return 0.6 - (mean_of(p.outline) - mean_of(q.outline)).norm(); }

}  // namespace

void Identities::carry_over(const SemanticLayers& before, SemanticLayers& now) {
  const auto likeness = [](const auto& p, const auto& q) { return likeness_of(p, q); };
  keep_ids(now.walls, before.walls, next_wall_, likeness);
  keep_ids(now.doors, before.doors, next_door_, likeness);
  keep_ids(now.rooms, before.rooms, next_room_, likeness);
  now.room_events = room_events(before.rooms, now.rooms);
  keep_ids(now.objects, before.objects, next_object_, likeness);
  for (Room& room : now.rooms) {
    room.name = room.corridor ? "Corridor " : "Room ";
    room.name += std::to_string(room.id);
  }
  join_rooms(now.doors, now.rooms);
}

}  // namespace modslam
