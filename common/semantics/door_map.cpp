// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/door_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace modslam {
namespace {

constexpr double kEvidencePerSighting = 0.4, kMaxEvidence = 12.0;

/// Sightings by the square of the floor that their centre lies in, so that a door looks only around itself.
class SightingIndex {
 public:
  SightingIndex(const std::vector<DoorSighting>& sightings, double square_m) : square_m_(square_m) {
    for (const DoorSighting& s : sightings) squares_[square(0.5 * (s.a + s.b))].push_back(&s);
  }
  template <class Visit>
  void each_near(const Eigen::Vector2d& p, Visit visit) const {
    const auto [x, y] = square(p);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        if (const auto found = squares_.find({x + dx, y + dy}); found != squares_.end())
          for (const DoorSighting* s : found->second) visit(*s);
  }

 private:
  std::pair<int, int> square(const Eigen::Vector2d& p) const {
    return {static_cast<int>(std::floor(p.x() / square_m_)), static_cast<int>(std::floor(p.y() / square_m_))};
  }
  double square_m_;
  std::map<std::pair<int, int>, std::vector<const DoorSighting*>> squares_;
};

int count_sightings(const Opening& opening, const SightingIndex& sightings, double centre_m) {
  const Eigen::Vector2d u = (opening.b - opening.a).normalized();
  int count = 0;
  sightings.each_near(opening.centre(), [&](const DoorSighting& s) {
    const Eigen::Vector2d d = s.b - s.a;
    count += (0.5 * (s.a + s.b) - opening.centre()).norm() < centre_m && std::abs(d.dot(u)) > 0.85 * d.norm() &&
             std::abs(d.norm() - opening.width_m()) < 0.45;
  });
  return count;
}

}  // namespace

std::vector<Door> find_doors(const Partition& partition, const std::vector<DoorSighting>& sightings, const DoorMapOptions& options) {
  const SightingIndex index(sightings, options.centre_m);
  std::vector<Door> doors;
  for (const CutOpening& cut : partition.cuts) {
    const Opening& opening = cut.opening;
    if (opening.width_m() < options.min_width_m || opening.width_m() > options.max_width_m) continue;
    Door door;
    door.a = opening.a;
    door.b = opening.b;
    const double from_shape = std::log(opening.probability / std::max(1e-6, 1 - opening.probability));
    const double from_sightings = kEvidencePerSighting * count_sightings(opening, index, options.centre_m);
    door.evidence = std::min(kMaxEvidence, from_shape + from_sightings);
    door.region_a = cut.left;
    door.region_b = cut.right;
    doors.push_back(door);
  }
  return doors;
}

}  // namespace modslam
