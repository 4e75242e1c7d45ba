// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_ends.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kBack_m = 0.3;   // of the wall itself: its last bins need not lie on occupied cells
constexpr double kAside_m = 0.15; // a face that the wall meets shows this far from it
constexpr double kBehind_m = 0.1; // free so far behind the line: beams that graze a wall make its near side free between two hits

double floor_m(const KnownSpace& space) { return space.resolution_m / std::sqrt(12.0); }

/// An end known to lie between `low` and `high`, told to be at 0.
WallEnd between(double low, double high, const KnownSpace& space) {
  const double mid = 0.5 * (low + high), width = high - low;
  return {0, std::max(floor_m(space), std::sqrt(width * width / 12 + mid * mid)), true};
}

}  // namespace

WallEnd look_beyond(const KnownSpace& space, const Eigen::Vector2d& p, const Eigen::Vector2d& u, const Eigen::Vector2d& normal) {
  const double cell_m = space.resolution_m, step_m = 0.5 * cell_m;
  const auto occupied = [&](const Eigen::Vector2d& q) { return space.is_occupied(space.cell(q)); };
  const auto free_at = [&](const Eigen::Vector2d& q) { return space.is_free(space.cell(q)); };
  const int last = static_cast<int>(kEndUnseen_m / step_m);
  double supported = -kBack_m, free = -1;
  bool ends = false;
  for (int k = -static_cast<int>(kBack_m / step_m); k <= last; ++k) {
    const double s = k * step_m;
    const Eigen::Vector2d q = p + s * u;
    if (occupied(q + kAside_m * normal) && occupied(q + (kAside_m + cell_m) * normal)) return between(s - step_m, s + cell_m, space);
    if (occupied(q) || occupied(q + cell_m * normal) || occupied(q - cell_m * normal)) {
      supported = s;
      ends = false;
    } else if (!ends && free_at(q) && free_at(q - kBehind_m * normal)) {
      free = s;
      ends = true;
    }
    if (ends && k >= 0) return between(supported - cell_m, free, space);  // somewhere in the last cell that something was hit in
  }
  return {0, kEndUnseen_m, false};
}

Numbers WallEnds::update(const WallSet& known, const Numbers& come, const KnownSpace& space, const Boxes& changed) {
  ends_.resize(known.end());
  Numbers looked = come;
  const auto look = [&](std::size_t number, bool at_b) {
    const Wall& wall = known[number];
    const Eigen::Vector2d u = wall.direction();
    ends_[number][at_b] = look_beyond(space, at_b ? wall.b : wall.a, at_b ? u : -u, wall.normal());
  };
  for (const std::size_t number : come)
    for (const bool at_b : {false, true}) look(number, at_b);
  const int reach = static_cast<int>(kEndUnseen_m / space.resolution_m) + 2;
  for (const cv::Rect& box : windows(changed, 0, space.occupancy.size()))
    for (const std::size_t number : known.near(space.place(box.x, box.y), space.place(box.br().x, box.br().y), reach * space.resolution_m))
      for (const bool at_b : {false, true})
        if (meet(box, grown(cv::Rect(space.cell(at_b ? known[number].b : known[number].a), cv::Size(1, 1)), reach))) {
          look(number, at_b);
          looked.push_back(number);
        }
  return looked;
}

void WallEnds::fill_in(std::size_t number, Wall& wall, const KnownSpace& space) const {
  const double least_m = floor_m(space);
  const auto& [at_a, at_b] = ends_[number];
  wall.at_a = {std::max(wall.at_a.across_m, least_m), at_a.along_m, at_a.seen};
  wall.at_b = {std::max(wall.at_b.across_m, least_m), at_b.along_m, at_b.seen};
}

}  // namespace modslam
