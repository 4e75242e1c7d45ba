// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/door_map.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kMinJambWall_m = 1.0;  // shorter faces are furniture rather than what a door hangs in
constexpr double kEvidencePerSighting = 0.4, kMaxEvidence = 12.0;

double free_share(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const KnownSpace& space) {
  const double length = (b - a).norm();
  const int steps = std::max(3, static_cast<int>(length / (0.5 * space.resolution_m)));
  int free = 0, looked = 0;
  for (int k = 0; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    if (share * length < 0.12 || (1 - share) * length < 0.12) continue;  // the jambs themselves
    ++looked;
    free += space.is_free(space.cell(a + share * (b - a)));
  }
  return looked ? static_cast<double>(free) / looked : 0.0;
}

/// Where the line from a wall's end along its direction meets another wall, if within reach.
bool meets(const Eigen::Vector2d& end, const Eigen::Vector2d& u, const Wall& other, double reach_m, Eigen::Vector2d& at) {
  const Eigen::Vector2d d = other.b - other.a, w = other.a - end;
  const double cross = u.x() * d.y() - u.y() * d.x();
  if (std::abs(cross) < 0.5 * d.norm()) return false;  // nearly parallel
  const double s = (w.x() * d.y() - w.y() * d.x()) / cross, t = (w.x() * u.y() - w.y() * u.x()) / cross;
  if (s <= 0 || s > reach_m || t < -0.1 || t > 1.1) return false;
  at = end + s * u;
  return true;
}

struct Gap {
  Eigen::Vector2d a, b;
};

std::vector<Gap> gaps_between_walls(const std::vector<WallBand>& bands, const DoorMapOptions& options) {
  std::vector<Gap> gaps;
  const auto fits = [&](double width_m) { return width_m >= options.min_width_m && width_m <= options.max_width_m; };
  for (const WallBand& band : bands) {
    for (std::size_t k = 0; k + 1 < band.walls.size(); ++k)
      if (fits((band.walls[k + 1].a - band.walls[k].b).norm()) &&
          band.walls[k].length_m() + band.walls[k + 1].length_m() > kMinJambWall_m)
        gaps.push_back({band.walls[k].b, band.walls[k + 1].a});
    // A door in the corner of a room: the second jamb is a wall across.
    for (std::size_t k = 0; k < band.walls.size(); ++k) {
      const Wall& wall = band.walls[k];
      if (wall.length_m() < kMinJambWall_m) continue;
      for (const bool at_end : {false, true}) {
        if (at_end ? k + 1 < band.walls.size() : k > 0) continue;
        const Eigen::Vector2d end = at_end ? wall.b : wall.a;
        const Eigen::Vector2d u = at_end ? wall.direction() : Eigen::Vector2d(-wall.direction());
        double nearest = options.max_width_m + 0.01;
        Eigen::Vector2d hit = end, at = end;
        for (const WallBand& other : bands)
          for (const Wall& across : other.walls)
            if (across.length_m() > kMinJambWall_m && meets(end, u, across, nearest, at)) {
              nearest = (at - end).norm();
              hit = at;
            }
        if (fits((hit - end).norm())) gaps.push_back({end, hit});
      }
    }
  }
  return gaps;
}

int count_sightings(const Gap& gap, const std::vector<DoorSighting>& sightings, const DoorMapOptions& options) {
  const Eigen::Vector2d centre = 0.5 * (gap.a + gap.b), u = (gap.b - gap.a).normalized();
  const double width = (gap.b - gap.a).norm();
  int count = 0;
  for (const DoorSighting& s : sightings) {
    const Eigen::Vector2d d = s.b - s.a;
    if ((0.5 * (s.a + s.b) - centre).squaredNorm() > options.centre_m * options.centre_m) continue;
    if (std::abs(d.dot(u)) < 0.85 * d.norm() || std::abs(d.norm() - width) > 0.45) continue;
    ++count;
  }
  return count;
}

}  // namespace

std::vector<Door> find_doors(const std::vector<WallBand>& bands, const std::vector<DoorSighting>& sightings,
                             const KnownSpace& space, const DoorMapOptions& options) {
  struct Weighted {
    Door door;
    int sightings;
    double weight;
  };
  std::vector<Weighted> found;
  std::vector<std::pair<int, Gap>> candidates;
  for (const Gap& gap : gaps_between_walls(bands, options)) {
    if (free_share(gap.a, gap.b, space) < options.min_free) continue;
    candidates.push_back({count_sightings(gap, sightings, options), gap});
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [count, gap] : candidates) {
    const Eigen::Vector2d centre = 0.5 * (gap.a + gap.b), u = (gap.b - gap.a).normalized();
    const auto same = std::find_if(found.begin(), found.end(), [&](const Weighted& w) {
      return (w.door.centre() - centre).norm() < options.merge_m && std::abs((w.door.b - w.door.a).normalized().dot(u)) > 0.9;
    });
    if (same == found.end()) {
      if (count < options.min_sightings) continue;
      Weighted fresh{{}, count, 1};
      fresh.door.a = gap.a;
      fresh.door.b = gap.b;
      found.push_back(fresh);
      continue;
    }
    // The other face of the same wall: the door lies between them.
    Door& door = same->door;
    const bool turned = (door.b - door.a).dot(gap.b - gap.a) < 0;
    const double w = same->weight;
    door.a = (w * door.a + (turned ? gap.b : gap.a)) / (w + 1);
    door.b = (w * door.b + (turned ? gap.a : gap.b)) / (w + 1);
    same->weight += 1;
    same->sightings += count;
  }
  std::vector<Door> doors;
  for (Weighted& w : found) {
    w.door.evidence = std::min(kMaxEvidence, kEvidencePerSighting * w.sightings);
    doors.push_back(w.door);
  }
  return doors;
}

}  // namespace modslam
