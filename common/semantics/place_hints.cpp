// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/place_hints.hpp"

#include <algorithm>

#include "common/semantics/room_finder.hpp"

namespace modslam {
namespace {

constexpr double kAtDoor_m = 0.4, kSquare_m = 3.2;

double distance_to_m(const Door& door, const Eigen::Vector2d& p) {
  const Eigen::Vector2d d = door.b - door.a;
  const double share = d.squaredNorm() > 0 ? std::clamp((p - door.a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (door.a + share * d - p).norm();
}

}  // namespace

PlaceHints::PlaceHints(const SemanticLayers& layers) : layers_(layers), doors_(kSquare_m), rooms_(kSquare_m) {
  for (std::size_t k = 0; k < layers.doors.size(); ++k) doors_.add(layers.doors[k].a, layers.doors[k].b, k);
  for (std::size_t k = 0; k < layers.rooms.size(); ++k) {
    const std::vector<Eigen::Vector2d>& outline = layers.rooms[k].outline;
    Eigen::Vector2d low = outline[0], high = low;
    for (const Eigen::Vector2d& p : outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
    rooms_.add(low, high, k);
  }
}

PlaceOnMap PlaceHints::at(const Eigen::Vector2d& p) const {
  PlaceOnMap out;
  rooms_.each_near(p, p, 0, [&](std::size_t k) {
    if (out.room >= 0 || !contains(layers_.rooms[k].outline, p)) return;
    out.room = static_cast<int>(k);
    out.hint = layers_.rooms[k].corridor ? PlaceHint::kInCorridor : PlaceHint::kInRoom;
  });
  doors_.each_near(p, p, kAtDoor_m, [&](std::size_t k) {
    if (distance_to_m(layers_.doors[k], p) <= kAtDoor_m) out.hint = PlaceHint::kAtDoor;
  });
  return out;
}

}  // namespace modslam
