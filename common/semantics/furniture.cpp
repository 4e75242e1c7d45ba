// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/furniture.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/semantics/plan_index.hpp"

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kLongest_m = 5.5;                          // of a front
constexpr double kLongDepth_m = 1.3;                        // its depth when it is long (counters, shelves) ...
constexpr double kBulky_m = 2.6, kBulkyDepth_m = 2.2;       // ... when it is not (beds, cupboards) ...
constexpr double kCarFrom_m = 1.4, kCarTo_m = 2.3, kCarDepth_m = 5.2;  // ... and of a parked car
constexpr double kSquare_m = 3.2, kBesideBack_m = 1.0;
const double kSameWay = std::cos(0.15);
constexpr double kLeastDepth_m = 0.15;
constexpr double kTouch_m = 0.25, kDoor_m = 1.7, kInLine_m = 0.12;
constexpr double kInwards_m2 = 0.5;
constexpr double kSmallGroup_m = 4.0;                       // a group of faces this small that nothing joins to others stands alone

/// What a front hides: from the line of the wall behind it up to itself.
struct Niche {
  Vec origin, along, out;  ///< a place on the wall's line; along it; towards the front
  double low, high, depth;

  bool holds(const Vec& p) const {
    const double u = along.dot(p - origin), v = out.dot(p - origin);
    return u > low - 0.2 && u < high + 0.2 && v > -0.2 && v < depth + 0.15;
  }
};

double deepest_m(double front_m) {
  if (front_m > kLongest_m) return 0;
  if (front_m > kCarFrom_m && front_m < kCarTo_m) return kCarDepth_m;
  return front_m < kBulky_m ? kBulkyDepth_m : kLongDepth_m;
}

double distance_to(const Vec& p, const Wall& wall) {
  const double t = std::clamp(wall.direction().dot(p - wall.a), 0.0, wall.length_m());
  return (p - wall.a - t * wall.direction()).norm();
}

class FurnitureFinder {
 public:
  FurnitureFinder(const std::vector<Wall>& walls, const std::function<bool(const Vec&)>& is_free)
      : walls_(walls), is_free_(is_free), furniture_(walls.size(), false), index_(kSquare_m) {
    for (std::size_t k = 0; k < walls.size(); ++k) {
      directions_.push_back(walls[k].direction());
      index_.add(walls[k].a, walls[k].b, k);
    }
  }

  std::vector<bool> run() {
    find_fronts();
    find_sides();
    find_lone_groups();
    return furniture_;
  }

 private:
  void find_fronts() {
    for (std::size_t i = 0; i < walls_.size(); ++i) {
      const double deepest = deepest_m(walls_[i].length_m());
      if (deepest == 0) continue;
      for (const std::size_t j : index_.near(walls_[i].a, walls_[i].b, deepest + kBesideBack_m))
        if (j != i && directions_[i].dot(directions_[j]) >= kSameWay && stands_before(walls_[i], walls_[j])) {
          furniture_[i] = true;
          break;
        }
    }
  }

  /// Whether the wall is seen beside the front, looks the same way, and nothing free lies between the two.
  bool stands_before(const Wall& front, const Wall& back) {
    const Vec d = back.direction(), out = back.normal();
    const Niche niche{back.a, d, out, d.dot(front.a - back.a), d.dot(front.b - back.a), out.dot(0.5 * (front.a + front.b) - back.a)};
    if (niche.depth < kLeastDepth_m || niche.depth > deepest_m(front.length_m())) return false;
    if (niche.low > back.length_m() + 0.5 || niche.high < -0.5) return false;
    if (free_between(front, 0.5 * niche.depth * out) > 0.3 || length_behind(back, niche) < 0.5 * front.length_m()) return false;
    niches_.push_back(niche);
    return true;
  }

  double free_between(const Wall& front, const Vec& half) const {
    int free = 0, asked = 0;
    for (double s = 0.1; s < front.length_m() - 0.1; s += 0.1, ++asked) free += is_free_(front.a + s * front.direction() - half);
    return asked ? static_cast<double>(free) / asked : 0;
  }

  double length_behind(const Wall& back, const Niche& niche) const {
    double sum = 0;
    const Vec low_end = niche.origin + niche.low * niche.along, high_end = niche.origin + niche.high * niche.along;
    for (const std::size_t k : index_.near(low_end, high_end, 1 + kInLine_m)) {
      const Wall& wall = walls_[k];
      if (niche.along.dot(directions_[k]) < 0.99 || std::abs(niche.out.dot(0.5 * (wall.a + wall.b) - back.a)) > kInLine_m) continue;
      const double low = niche.along.dot(wall.a - niche.origin), high = niche.along.dot(wall.b - niche.origin);
      if (low < niche.high + 1 && high > niche.low - 1) sum += wall.length_m();
    }
    return sum;
  }

  void find_sides() {
    for (const Niche& niche : niches_) {
      const Vec low = niche.origin + niche.low * niche.along, high = niche.origin + niche.high * niche.along + niche.depth * niche.out;
      for (const std::size_t i : index_.near(low, high, niche.depth))
        if (std::abs(niche.along.dot(directions_[i])) < 0.3 && niche.holds(walls_[i].a) && niche.holds(walls_[i].b)) furniture_[i] = true;
    }
  }

  bool belong_together(const Wall& p, const Wall& q) const {
    const Vec apart = (p.a.cwiseMin(p.b) - q.a.cwiseMax(q.b)).cwiseMax(q.a.cwiseMin(q.b) - p.a.cwiseMax(p.b));
    if (apart.maxCoeff() > kDoor_m + 0.3) return false;
    const Vec u = p.direction();
    const double gap = std::max(u.dot(q.a - p.b), u.dot(p.a - q.b));
    const bool in_line = std::abs(u.dot(q.direction())) > 0.985 && std::abs(p.normal().dot(q.a - p.a)) < kInLine_m + 0.2 &&
                         std::abs(p.normal().dot(q.b - p.a)) < kInLine_m + 0.2;
    if (in_line) {
      const double nearest = std::min({(p.a - q.a).norm(), (p.a - q.b).norm(), (p.b - q.a).norm(), (p.b - q.b).norm()});
      if (gap < kDoor_m && nearest < kDoor_m + 0.3) return true;
    }
    return std::min({distance_to(p.a, q), distance_to(p.b, q), distance_to(q.a, p), distance_to(q.b, p)}) < kTouch_m;
  }

  /// Walls that a wall hangs together with, itself among them; no more than it takes to see that they are no small group.
  std::vector<std::size_t> group_of(std::size_t first, const std::vector<bool>& front, Vec& low, Vec& high) const {
    std::vector<std::size_t> group{first};
    std::set<std::size_t> known{first};
    low = Vec(1e9, 1e9);
    high = -low;
    for (std::size_t next = 0; next < group.size(); ++next) {
      const Wall& wall = walls_[group[next]];
      low = low.cwiseMin(wall.a).cwiseMin(wall.b);
      high = high.cwiseMax(wall.a).cwiseMax(wall.b);
      if ((high - low).norm() >= kSmallGroup_m) break;
      for (const std::size_t j : index_.near(wall.a, wall.b, kDoor_m + 0.3))
        if (!front[j] && !known.count(j) && (belong_together(wall, walls_[j]) || belong_together(walls_[j], wall))) group.push_back(j), known.insert(j);
    }
    return group;
  }

  void find_lone_groups() {
    Vec all_low(1e9, 1e9), all_high(-1e9, -1e9);
    for (const Wall& wall : walls_) {
      all_low = all_low.cwiseMin(wall.a).cwiseMin(wall.b);
      all_high = all_high.cwiseMax(wall.a).cwiseMax(wall.b);
    }
    if (walls_.empty() || (all_high - all_low).norm() < 2 * kSmallGroup_m) return;  // nothing larger was seen yet
    const std::vector<bool> front = furniture_;
    for (std::size_t i = 0; i < walls_.size(); ++i) {
      if (furniture_[i] || walls_[i].length_m() >= kSmallGroup_m) continue;
      Vec low, high;
      const std::vector<std::size_t> group = group_of(i, front, low, high);
      if ((high - low).norm() >= kSmallGroup_m) continue;
      // The faces of a small room look inwards, those of a thing outwards.
      double outwards = 0;
      for (const std::size_t k : group) outwards += walls_[k].length_m() * walls_[k].normal().dot(0.5 * (walls_[k].a + walls_[k].b) - 0.5 * (low + high));
      for (const std::size_t k : group)
        if (outwards > -kInwards_m2) furniture_[k] = true;
    }
  }

  const std::vector<Wall>& walls_;
  const std::function<bool(const Vec&)>& is_free_;
  std::vector<bool> furniture_;
  std::vector<Niche> niches_;
  std::vector<Vec> directions_;
  PlanIndex index_;
};

}  // namespace

std::vector<bool> find_furniture(const std::vector<Wall>& walls, const std::function<bool(const Eigen::Vector2d&)>& is_free) {
  return FurnitureFinder(walls, is_free).run();
}

}  // namespace modslam
