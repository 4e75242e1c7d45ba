// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/identities.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

/// Metres that two faces on nearly one line have in common.
double overlap(const Wall& p, const Wall& q) {
  const Eigen::Vector2d d = p.segment.direction(), n(-d.y(), d.x());
  if (d.dot(q.segment.direction()) < 0.97 ||
      std::abs(n.dot(q.segment.centre() - p.segment.a)) > 0.15)
    return 0;
  const double low = std::max(0.0, d.dot(q.segment.a - p.segment.a));
  const double high = std::min(p.segment.length_m(), d.dot(q.segment.b - p.segment.a));
  return std::max(0.0, high - low);
}

/// 1 at the same place, 0 from 0.6 m on.
double overlap(const Door& p, const Door& q) {
  return std::max(0.0, 1 - (p.segment.centre() - q.segment.centre()).norm() / 0.6);
}

/// Square metres in common, counted in cells of 0.25 m of the smaller box.
double overlap(const Polygon& p, const Polygon& q) {
  Eigen::Array2d low(-1e18, -1e18), high(1e18, 1e18);
  for (const Polygon* polygon : {&p, &q}) {
    Eigen::Array2d own_low(1e18, 1e18), own_high(-1e18, -1e18);
    for (const Eigen::Vector2d& corner : *polygon) {
      own_low = own_low.min(corner.array());
      own_high = own_high.max(corner.array());
    }
    low = low.max(own_low);
    high = high.min(own_high);
  }
  if ((low >= high).any()) return 0;
  constexpr int kSteps = 16;
  const Eigen::Array2d step = (high - low) / kSteps;
  int inside = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Eigen::Vector2d at = (low + step * Eigen::Array2d(i + 0.5, j + 0.5)).matrix();
      inside += contains(p, at) && contains(q, at);
    }
  }
  return inside * step.prod();
}
double overlap(const Room& p, const Room& q) { return overlap(p.outline, q.outline); }
double overlap(const Object& p, const Object& q) { return overlap(p.outline, q.outline); }

/// Greedy by the largest overlap; ties by order. `on_match(old, new)` sees every pair.
template <class Thing, class OnMatch>
void match(const std::vector<Thing>& before, std::vector<Thing>& now, std::int64_t& next,
           OnMatch&& on_match) {
  struct Pair {
    double overlap;
    std::size_t before, now;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (std::size_t j = 0; j < now.size(); ++j) {
      const double common = overlap(before[i], now[j]);
      if (common > 0) pairs.push_back({common, i, j});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& p, const Pair& q) { return p.overlap > q.overlap; });
  std::vector<bool> used(before.size());
  for (const Pair& pair : pairs) {
    if (used[pair.before] || now[pair.now].id != 0) continue;
    used[pair.before] = true;
    now[pair.now].id = before[pair.before].id;
    on_match(before[pair.before], now[pair.now]);
  }
  for (Thing& thing : now)
    if (thing.id == 0) thing.id = next++;
}

}  // namespace

void Identities::carry_over(const Semantics& before, Semantics& now, std::int64_t utime) {
  const auto nothing = [](const auto&, auto&) {};
  match(before.walls, now.walls, next_wall_, nothing);
  match(before.doors, now.doors, next_door_, nothing);
  match(before.rooms, now.rooms, next_room_,
        [](const Room& old, Room& room) { room.name = old.name; });
  for (Object& object : now.objects) object.first_utime = object.last_utime = utime;
  match(before.objects, now.objects, next_object_, [](const Object& old, Object& object) {
    object.first_utime = old.first_utime;
    const bool unchanged = old.area_m2 == object.area_m2 && old.evidence == object.evidence;
    if (unchanged) object.last_utime = old.last_utime;
  });
}

}  // namespace modslam
