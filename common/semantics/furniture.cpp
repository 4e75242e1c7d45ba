// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/furniture.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kLongDepth_m = 1.3;                        // depth behind a long front (counters, shelves) ...
constexpr double kBulky_m = 2.6, kBulkyDepth_m = 2.2;       // ... when it is not (beds, cupboards) ...
constexpr double kLongestCounter_m = 8.0, kCounterDepth_m = 2.2, kBesideCounter_m = 0.5, kShareBesideCounter = 0.3;  // counters: wall is seen at both their ends
constexpr double kCarFrom_m = 1.4, kCarTo_m = 2.3, kCarDepth_m = 5.2;  // ... and of a parked car
constexpr double kBesideBack_m = 1.0, kPastBack_m = 0.5;
const double kSameWay = std::cos(0.15);
constexpr double kLeastDepth_m = 0.15;
constexpr double kTouch_m = 0.25, kDoor_m = 1.7, kInLine_m = 0.12;
constexpr double kThickest_m = 0.65;                       // of a wall
constexpr double kInwards_m2 = 0.5;
constexpr double kSmallGroup_m = 4.0;                       // a group of faces this small that nothing joins to others stands alone
constexpr double kPiece_m = 1.2, kThin_m = 0.35;           // ... unless it is a piece of wall between doors
constexpr double kMostFloor = 0.3;                         // of the footprint of a thing
constexpr double kNext_m = kDoor_m + 0.3;                   // faces of one group are this near

double deepest_m(double front_m) {
  if (front_m > kLongestCounter_m) return 0;
  if (front_m > kLongestFront_m) return kCounterDepth_m;
  if (front_m > kCarFrom_m && front_m < kCarTo_m) return kCarDepth_m;
  return front_m < kBulky_m ? kBulkyDepth_m : kLongDepth_m;
}

/// What lies farther from a front has no say in what it hides.
double reach_m(double front_m) { return deepest_m(front_m) + kBesideBack_m + 2 * kInLine_m; }

double distance_to(const Vec& p, const Wall& wall) {
  const Vec d = wall.b - wall.a;
  return (p - wall.a - std::clamp(d.dot(p - wall.a) / d.squaredNorm(), 0.0, 1.0) * d).norm();
}

PlanBox box_of(const Wall& wall) { return {wall.a.cwiseMin(wall.b), wall.a.cwiseMax(wall.b)}; }

bool meet(const PlanBox& p, const PlanBox& q, double margin_m) {
  return ((p.low.array() - margin_m) <= q.high.array()).all() && ((q.low.array() - margin_m) <= p.high.array()).all();
}

double free_between(const Wall& front, const Vec& half, const FurnitureMap::IsFree& is_free) {
  const Vec u = front.direction();
  int free = 0, asked = 0;
  for (double s = 0.1, end = front.length_m() - 0.1; s < end; s += 0.1, ++asked) free += is_free(front.a + s * u - half);
  return asked ? static_cast<double>(free) / asked : 0;
}

/// Whether the two are the faces of one wall: they look away from each other, and no more than a wall is between them.
bool are_back_to_back(const Wall& p, const Wall& q, const Vec& u) {
  if (u.dot(q.direction()) > -0.985) return false;
  const double thick_m = -p.normal().dot(0.5 * (q.a + q.b) - p.a);
  const double low = std::max(0.0, u.dot(q.b - p.a)), high = std::min(p.length_m(), u.dot(q.a - p.a));
  return thick_m > 0 && thick_m < kThickest_m && high - low > 0.5 * std::min(p.length_m(), q.length_m());
}

bool belong_together(const Wall& p, const Wall& q) {
  if (!meet(box_of(p), box_of(q), kNext_m)) return false;
  const Vec u = p.direction();
  if (are_back_to_back(p, q, u)) return true;
  const double gap = std::max(u.dot(q.a - p.b), u.dot(p.a - q.b));
  const bool in_line = std::abs(u.dot(q.direction())) > 0.985 && std::abs(p.normal().dot(q.a - p.a)) < kInLine_m + 0.2 &&
                       std::abs(p.normal().dot(q.b - p.a)) < kInLine_m + 0.2;
  if (in_line) {
    const double nearest = std::min({(p.a - q.a).norm(), (p.a - q.b).norm(), (p.b - q.a).norm(), (p.b - q.b).norm()});
    if (gap < kDoor_m && nearest < kNext_m) return true;
  }
  return std::min({distance_to(p.a, q), distance_to(p.b, q), distance_to(q.a, p), distance_to(q.b, p)}) < kTouch_m;
}

}  // namespace

bool FurnitureMap::Niche::holds(const Vec& p) const {
  const double u = along.dot(p - origin), v = out.dot(p - origin);
  return u > low - 0.2 && u < high + 0.2 && v > -0.2 && v < depth + 0.15;
}

PlanBox FurnitureMap::Niche::box() const {
  const Vec p = origin + low * along, q = origin + high * along, up = depth * out;
  return {(p.cwiseMin(q).cwiseMin(p + up).cwiseMin(q + up)).array() - 0.3, (p.cwiseMax(q).cwiseMax(p + up).cwiseMax(q + up)).array() + 0.3};
}

std::array<Vec, 4> FurnitureMap::Niche::ring() const {
  const Vec from = origin + low * along, to = origin + high * along;
  return {from, to, to + depth * out, from + depth * out};
}

void FurnitureMap::set_niche(std::size_t number, const std::optional<Niche>& niche) {
  std::optional<Niche>& known = niches_[number];
  if (known) {
    niche_index_.remove(known->box().low, known->box().high, number);
    fronts_.erase(std::find(fronts_.begin(), fronts_.end(), number));
  }
  if (niche) {
    niche_index_.add(niche->box().low, niche->box().high, number);
    fronts_.push_back(number);
  }
  known = niche;
  front_[number] = niche.has_value();
  touched_.push_back(number);
  floor_[number].reset();
}

/// Behind the front is the nearest wall that is seen beside it and looks the same way, with nothing free between the two.
std::optional<FurnitureMap::Niche> FurnitureMap::niche_of(const Wall& front, const IsFree& is_free) const {
  const double length_m = front.length_m(), deepest = deepest_m(length_m);
  if (deepest == 0) return std::nullopt;
  std::optional<Niche> found;
  const Vec direction = front.direction();
  const auto order = [](const Niche& n) { return std::tuple(n.depth, n.origin.x(), n.origin.y(), n.low, n.high); };
  for (const std::size_t j : walls_.near(front.a, front.b, deepest + kBesideBack_m)) {
    const Wall& back = walls_[j];
    if (!meet(box_of(front), box_of(back), deepest + kBesideBack_m)) continue;
    const Vec d = back.direction(), out = back.normal();
    if (direction.dot(d) < kSameWay || (front.a == back.a && front.b == back.b)) continue;
    const Niche niche{back.a, d, out, d.dot(front.a - back.a), d.dot(front.b - back.a), out.dot(0.5 * (front.a + front.b) - back.a)};
    const double least_m = std::min(out.dot(front.a - back.a), out.dot(front.b - back.a));  // a wall that bends away begins where this one ends
    if (least_m < kLeastDepth_m || niche.depth > deepest || (found && order(*found) < order(niche))) continue;
    if (niche.low > back.length_m() + kPastBack_m || niche.high < -kPastBack_m) continue;
    if (free_between(front, 0.5 * niche.depth * out, is_free) > 0.3 || !is_wall_behind(front, back, niche)) continue;
    found = niche;
  }
  return found;
}

/// Beside the front, in line with its back, wall was seen: half as long as the front; a long one shows it at both ends.
bool FurnitureMap::is_wall_behind(const Wall& front, const Wall& back, const Niche& niche) const {
  std::vector<double> lengths;
  double before_m = 0, beyond_m = 0;
  const Vec low_end = niche.origin + niche.low * niche.along, high_end = niche.origin + niche.high * niche.along;
  for (const std::size_t k : walls_.near(low_end, high_end, kBesideBack_m + 2 * kInLine_m)) {
    const Wall& wall = walls_[k];
    if (!meet(box_of(front), box_of(wall), reach_m(front.length_m()))) continue;
    if (niche.along.dot(wall.direction()) < 0.99 || std::abs(niche.out.dot(0.5 * (wall.a + wall.b) - back.a)) > kInLine_m) continue;
    const double low = niche.along.dot(wall.a - niche.origin), high = niche.along.dot(wall.b - niche.origin);
    if (low > niche.high + kBesideBack_m || high < niche.low - kBesideBack_m) continue;
    lengths.push_back(wall.length_m());
    before_m = std::max(before_m, niche.low - low);
    beyond_m = std::max(beyond_m, high - niche.high);
  }
  if (front.length_m() > kLongestFront_m)
    return std::min(before_m, beyond_m) > kBesideCounter_m && before_m + beyond_m > kShareBesideCounter * front.length_m();
  std::sort(lengths.begin(), lengths.end());  // the sum does not depend on who came first
  double sum = 0;
  for (const double length : lengths) sum += length;
  return sum >= 0.5 * front.length_m();
}

bool FurnitureMap::is_side(const Wall& wall) const {
  const Vec u = wall.direction();
  for (const std::size_t k : niche_index_.near(wall.a, wall.b, 0)) {
    const Niche& niche = *niches_[k];
    if (std::abs(niche.along.dot(u)) < 0.3 && niche.holds(wall.a) && niche.holds(wall.b)) return true;
  }
  return false;
}

Numbers FurnitureMap::near(const std::vector<PlanBox>& boxes, double margin_m) const {
  Numbers out;
  std::vector<char> is_in(walls_.end(), false);
  for (const PlanBox& box : boxes)
    walls_.each_near(box.low, box.high, margin_m, [&](std::size_t k) {
      if (is_in[k] || !meet(box, box_of(walls_[k]), margin_m)) return;
      is_in[k] = true;
      out.push_back(k);
    });
  std::sort(out.begin(), out.end());
  return out;
}

void FurnitureMap::find_fronts(const Numbers& numbers, const IsFree& is_free, std::vector<PlanBox>& stirred) {
  for (const std::size_t k : numbers) {
    const std::optional<Niche> niche = niche_of(walls_[k], is_free);
    if (niche == niches_[k]) continue;
    for (const auto& one : {niches_[k], niche})
      if (one) stirred.push_back(one->box());
    stirred.push_back(box_of(walls_[k]));
    set_niche(k, niche);
  }
}

void FurnitureMap::find_sides(const Numbers& numbers, std::vector<PlanBox>& stirred) {
  for (const std::size_t k : numbers)
    if (const char side = is_side(walls_[k]); side != side_[k]) {
      side_[k] = side;
      touched_.push_back(k);
      stirred.push_back(box_of(walls_[k]));
    }
}

/// Walls that a wall hangs together with, itself among them; no more than it takes to see that they are no small group.
Numbers FurnitureMap::group_of(std::size_t first, PlanBox& box) const {
  Numbers group{first};
  box = box_of(walls_[first]);
  for (std::size_t next = 0; next < group.size(); ++next) {
    const Wall& wall = walls_[group[next]];
    box.low = box.low.cwiseMin(box_of(wall).low);
    box.high = box.high.cwiseMax(box_of(wall).high);
    if ((box.high - box.low).norm() >= kSmallGroup_m) break;
    for (const std::size_t j : walls_.near(wall.a, wall.b, kNext_m))
      if (!is_part(j) && (belong_together(wall, walls_[j]) || belong_together(walls_[j], wall)) && std::find(group.begin(), group.end(), j) == group.end())
        group.push_back(j);
  }
  return group;
}

/// Long and no thicker than a wall, or of which only one face was seen.
bool FurnitureMap::is_piece_of_wall(const Numbers& group) const {
  const auto longest = *std::max_element(group.begin(), group.end(), [&](std::size_t p, std::size_t q) { return walls_[p].length_m() < walls_[q].length_m(); });
  const Wall& face = walls_[longest];
  Vec low(0, 0), high(0, 0);
  for (const std::size_t k : group)
    for (const Vec& p : {walls_[k].a, walls_[k].b}) {
      const Vec here(face.direction().dot(p - face.a), face.normal().dot(p - face.a));
      low = low.cwiseMin(here);
      high = high.cwiseMax(here);
    }
  return high.x() - low.x() > kPiece_m && high.y() - low.y() < kThin_m;
}

void FurnitureMap::find_lone_groups(const Numbers& numbers) {
  touched_.insert(touched_.end(), numbers.begin(), numbers.end());
  for (const std::size_t k : numbers) lone_[k] = false;
  if (!was_large_) return;
  const auto order = [&](std::size_t k) { return std::tuple(walls_[k].a.x(), walls_[k].a.y(), walls_[k].b.x(), walls_[k].b.y()); };
  for (const std::size_t i : numbers) {
    if (lone_[i] || is_part(i) || walls_[i].length_m() >= kSmallGroup_m) continue;
    PlanBox box;
    Numbers group = group_of(i, box);
    if ((box.high - box.low).norm() >= kSmallGroup_m) continue;
    std::sort(group.begin(), group.end(), [&](std::size_t p, std::size_t q) { return order(p) < order(q); });
    // The faces of a small room look inwards, those of a thing outwards.
    double outwards = 0;
    for (const std::size_t k : group) outwards += walls_[k].length_m() * walls_[k].normal().dot(0.5 * (walls_[k].a + walls_[k].b) - 0.5 * (box.low + box.high));
    for (const std::size_t k : group) lone_[k] = outwards > -kInwards_m2 && !is_piece_of_wall(group);
    touched_.insert(touched_.end(), group.begin(), group.end());
  }
}

/// Whether something larger than a group was seen yet.
bool FurnitureMap::is_large() const {
  PlanBox all{Vec(1e9, 1e9), Vec(-1e9, -1e9)};
  for (std::size_t k = 0; k < walls_.end(); ++k) {
    if (!walls_.has(k)) continue;
    all.low = all.low.cwiseMin(box_of(walls_[k]).low);
    all.high = all.high.cwiseMax(box_of(walls_[k]).high);
    if ((all.high - all.low).norm() >= 2 * kSmallGroup_m) return true;
  }
  return false;
}

Numbers FurnitureMap::update(const NumberNews& news, const Slots<Wall>& walls, const IsFree& is_free, const std::vector<PlanBox>& changed) {
  walls_.take(news, walls);
  touched_.clear();
  niches_.resize(walls_.end());
  floor_.resize(walls_.end());
  for (std::vector<char>* flags : {&front_, &side_, &lone_}) flags->resize(walls_.end());
  std::vector<PlanBox> moved;
  for (const Numbers* numbers : {&news.gone, &news.come})
    for (const std::size_t k : *numbers) moved.push_back(box_of(walls_[k]));
  std::vector<PlanBox> stirred = moved;
  for (const std::size_t k : news.gone) {
    if (niches_[k]) stirred.push_back(niches_[k]->box());
    set_niche(k, std::nullopt);
    side_[k] = lone_[k] = false;
  }
  for (const PlanBox& box : changed) niche_index_.each_near(box.low, box.high, 0, [&](std::size_t k) { floor_[k].reset(); });
  std::vector<PlanBox> seen = moved;
  seen.insert(seen.end(), changed.begin(), changed.end());
  Numbers fronts;
  for (const std::size_t k : near(seen, reach_m(kCarFrom_m + 0.1))) {
    const double margin_m = reach_m(walls_[k].length_m());
    if (deepest_m(walls_[k].length_m()) > 0 && std::any_of(seen.begin(), seen.end(), [&](const PlanBox& box) { return meet(box, box_of(walls_[k]), margin_m); }))
      fronts.push_back(k);
  }
  find_fronts(fronts, is_free, stirred);
  find_sides(near(stirred, 0), stirred);
  const bool large = is_large();
  const bool all = large != was_large_;
  was_large_ = large;
  find_lone_groups(all ? walls_.numbers() : near(stirred, kSmallGroup_m + kNext_m + 0.1));
  return std::exchange(touched_, {});
}

std::vector<std::array<Vec, 4>> FurnitureMap::footprints(const IsFree& is_free) {
  Numbers known;
  std::copy_if(fronts_.begin(), fronts_.end(), std::back_inserter(known), [&](std::size_t k) { return !side_[k]; });
  const auto order = [&](std::size_t k) {
    const Niche& n = *niches_[k];
    return std::tuple(-n.depth, n.origin.x(), n.origin.y(), n.low, n.high);
  };
  std::sort(known.begin(), known.end(), [&](std::size_t p, std::size_t q) { return order(p) < order(q); });
  std::vector<char> taken(niches_.size(), false);
  std::vector<std::array<Vec, 4>> out;
  for (const std::size_t k : known) {
    const std::array<Vec, 4> ring = niches_[k]->ring();
    // What lies behind another front is the same thing seen twice.
    const Vec middle = 0.5 * (ring[0] + ring[2]);
    bool twice = false;
    niche_index_.each_near(middle, middle, 0, [&](std::size_t j) { twice = twice || (taken[j] && niches_[j]->holds(middle)); });
    if (twice) continue;
    taken[k] = true;
    if (!floor_[k]) floor_[k] = floor_share(ring, is_free);
    if (*floor_[k] < kMostFloor) out.push_back(ring);
  }
  return out;
}

double floor_share(const std::array<Vec, 4>& ring, const FurnitureMap::IsFree& is_free) {
  constexpr double kStep_m = 0.1;
  const Vec along = ring[1] - ring[0], out = ring[3] - ring[0];
  const int columns = std::max(1, static_cast<int>(along.norm() / kStep_m)), rows = std::max(1, static_cast<int>(out.norm() / kStep_m));
  int free = 0;
  for (int x = 0; x < columns; ++x)
    for (int y = 0; y < rows; ++y) free += is_free(ring[0] + (x + 0.5) / columns * along + (y + 0.5) / rows * out);
  return static_cast<double>(free) / (columns * rows);
}

std::vector<bool> find_furniture(const std::vector<Wall>& walls, const FurnitureMap::IsFree& is_free) {
  Slots<Wall> numbered;
  NumberNews news;
  for (const Wall& wall : walls) news.come.push_back(numbered.take(wall));
  FurnitureMap map;
  map.update(news, numbered, is_free, {});
  std::vector<bool> flags;
  for (const std::size_t number : news.come) flags.push_back(map.is_furniture(number));
  return flags;
}

}  // namespace modslam
