// SPDX-License-Identifier: BSD-3-Clause
#include "procs/learn_places/office_maker.hpp"

#include <algorithm>

#include "common/world/random.hpp"

namespace modslam {
namespace {

using Point = Eigen::Vector2d;

class Office {
 public:
  explicit Office(std::uint64_t seed) : random_(seed, RandomStreamId::kLaser), wall_m_(random_.uniform(0.05, 0.25)) {
    world_.name = "office " + std::to_string(seed);
  }

  World make() {
    length_m_ = random_.uniform(14, 45);
    half_m_ = 0.5 * seldom_large(1.5, 7);
    const double top_m = seldom_large(2.6, 10), bottom_m = seldom_large(2.6, 10);
    add_row(1, top_m);
    add_row(-1, bottom_m);
    wall({0, -half_m_}, {0, half_m_});
    corridor({0, -half_m_}, {length_m_, half_m_});
    const bool across = random_.uniform() < 0.6;
    if (!across) wall({length_m_, -half_m_}, {length_m_, half_m_});
    add_tour();
    if (across) add_corridor_across(top_m, bottom_m);
    world_.start = tour_.points.front();
    world_.routes.push_back(tour_);
    return std::move(world_);
  }

 private:
  struct Stop {
    Point door, inside, middle;
  };

  double seldom_large(double low, double high) {
    const double share = random_.uniform();
    return low + (high - low) * share * share;
  }

  void wall(const Point& a, const Point& b) {
    if ((b - a).norm() > 0.02) world_.walls.push_back({"w" + std::to_string(world_.walls.size()), a, b, wall_m_});
  }

  void room(const Point& low, const Point& high, const char* category) {
    const Point inset = Point::Constant(wall_m_ / 2);
    const Point a = low + inset, b = high - inset;
    world_.rooms.push_back({"r" + std::to_string(world_.rooms.size()), category, category, {a, {b.x(), a.y()}, b, {a.x(), b.y()}}, {}});
  }
  void corridor(const Point& low, const Point& high) { room(low, high, "corridor"); }

  /// Rooms along one side of the corridor (side 1: above), `depth_m` deep, each with a door to it.
  void add_row(int side, double depth_m) {
    const double near = side * half_m_, far = side * (half_m_ + depth_m);
    double x = 0, open_from = 0;
    while (x < length_m_ - 1e-9) {
      double to = x + seldom_large(2.4, 13);
      if (length_m_ - to < 2.4) to = length_m_;
      const double width_m = random_.uniform(0.75, 1.3);
      const double door = random_.uniform(x + 0.3 + width_m / 2, to - 0.3 - width_m / 2);
      wall({open_from, near}, {door - width_m / 2, near});
      open_from = door + width_m / 2;
      world_.doors.push_back({"d" + std::to_string(world_.doors.size()), {door - width_m / 2, near}, {open_from, near}, width_m, true});
      wall({to, near}, {to, far});
      room({x, std::min(near, far)}, {to, std::max(near, far)}, "office");
      const double reach = std::min(depth_m / 2, 3.0);
      stops_.push_back({{door, near}, {door, near + side * 0.8}, {(x + to) / 2 + random_.uniform(-0.3, 0.3), near + side * std::max(1.0, reach)}});
      x = to;
    }
    wall({open_from, near}, {length_m_, near});
    wall({0, near}, {0, far});
    wall({0, far}, {length_m_, far});
  }

  /// Into each room in the order of their doors along the corridor.
  void add_tour() {
    tour_.id = "tour";
    tour_.speed_mps = 0.8;
    tour_.corner_radius_m = 0.3;
    tour_.turn_in_place = true;
    std::sort(stops_.begin(), stops_.end(), [](const Stop& p, const Stop& q) { return p.door.x() < q.door.x(); });
    go({0.6, 0});
    for (const Stop& stop : stops_) {
      const double y = random_.uniform(-0.3, 0.3) * std::max(0.0, half_m_ - 0.6);
      go({stop.door.x(), y});
      go(stop.inside);
      go(stop.middle);
      go(stop.inside);
      go({stop.door.x(), y});
    }
    go({length_m_ - 0.6, 0});
  }

  void add_corridor_across(double top_m, double bottom_m) {
    const double width_m = seldom_large(1.5, 7), up = half_m_ + top_m + random_.uniform(0, 8), down = -half_m_ - bottom_m - random_.uniform(0, 8);
    const double right = length_m_ + width_m, middle = length_m_ + width_m / 2;
    wall({length_m_, half_m_}, {length_m_, up});
    wall({length_m_, -half_m_}, {length_m_, down});
    wall({right, down}, {right, up});
    wall({length_m_, up}, {right, up});
    wall({length_m_, down}, {right, down});
    corridor({length_m_, down}, {right, up});
    go({middle, 0});
    go({middle, up - 0.7});
    go({middle, down + 0.7});
  }

  void go(const Point& p) {
    if (tour_.points.empty() || (tour_.points.back() - p).norm() > 0.05) tour_.points.push_back(p);
  }

  RandomStream random_;
  double wall_m_, length_m_ = 0, half_m_ = 0;
  World world_;
  Route tour_;
  std::vector<Stop> stops_;
};

}  // namespace

World make_office(std::uint64_t seed) { return Office(seed).make(); }

}  // namespace modslam
