// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/door_map.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kEvidencePerSighting = 0.4, kMaxEvidence = 12.0;

constexpr double kSquare_m = 0.4;

std::pair<int, int> square_of(const Eigen::Vector2d& p) { return {static_cast<int>(std::floor(p.x() / kSquare_m)), static_cast<int>(std::floor(p.y() / kSquare_m))}; }

std::int64_t key_of(const std::pair<int, int>& square) { return square.first * (std::int64_t{1} << 32) + square.second; }

Eigen::Vector2d centre_of(const DoorSighting& s) { return 0.5 * (s.a + s.b); }

}  // namespace

void DoorSightings::add(const DoorSighting& sighting, int sign) {
  if (!(centre_of(sighting).cwiseAbs().maxCoeff() < 1e6)) return;
  stirred_.push_back(centre_of(sighting));
  std::vector<DoorSighting>& here = squares_[key_of(square_of(centre_of(sighting)))];
  if (sign > 0) {
    here.push_back(sighting);
    return;
  }
  const auto same = [&](const DoorSighting& other) { return other.a == sighting.a && other.b == sighting.b; };
  if (const auto found = std::find_if(here.begin(), here.end(), same); found != here.end()) here.erase(found);
}

int DoorSightings::count(const Gap& opening, double centre_m) const {
  const Eigen::Vector2d u = (opening.b - opening.a).normalized(), reach(centre_m, centre_m);
  const auto low = square_of(opening.centre() - reach), high = square_of(opening.centre() + reach);
  int count = 0;
  for (int x = low.first; x <= high.first; ++x)
    for (int y = low.second; y <= high.second; ++y) {
      const auto square = squares_.find(key_of({x, y}));
      if (square == squares_.end()) continue;
      for (const DoorSighting& s : square->second) {
        const Eigen::Vector2d d = s.b - s.a;
        count += (centre_of(s) - opening.centre()).norm() < centre_m && std::abs(d.dot(u)) > 0.85 * d.norm() && std::abs(d.norm() - opening.width_m()) < 0.45;
      }
    }
  return count;
}

bool DoorSightings::is_stirred(const Gap& opening, double centre_m) const {
  const Eigen::Vector2d centre = opening.centre();
  return std::any_of(stirred_.begin(), stirred_.end(), [&](const Eigen::Vector2d& p) { return (p - centre).squaredNorm() <= centre_m * centre_m; });
}

std::vector<int> DoorSightings::support(const std::vector<CutOpening>& cuts, double centre_m) {
  if (stirred_.size() > cuts.size()) known_.clear();  // much moved: counting costs less than looking for what stayed
  ++round_;
  std::vector<int> out;
  out.reserve(cuts.size());
  for (const CutOpening& cut : cuts) {
    const Gap& gap = cut.opening;
    if (cut.number >= known_.size()) known_.resize(cut.number + 1);
    Known& known = known_[cut.number];
    const bool stays = known.round == round_ - 1 && known.a == gap.a && known.b == gap.b && !is_stirred(gap, centre_m);
    known = {gap.a, gap.b, round_, stays ? known.count : count(gap, centre_m)};
    out.push_back(known.count);
  }
  stirred_.clear();
  return out;
}

std::vector<Door> find_doors(const Partition& partition, const std::vector<DoorSighting>& sightings, const DoorMapOptions& options) {
  DoorSightings all;
  for (const DoorSighting& sighting : sightings) all.add(sighting, 1);
  return find_doors(partition, all, options);
}

std::vector<Door> find_doors(const Partition& partition, DoorSightings& sightings, const DoorMapOptions& options) {
  std::vector<Door> doors;
  const std::vector<int> support = sightings.support(partition.cuts, options.centre_m);
  for (std::size_t k = 0; k < partition.cuts.size(); ++k) {
    const CutOpening& cut = partition.cuts[k];
    const Gap& opening = cut.opening;
    if (opening.width_m() < options.min_width_m || opening.width_m() > options.max_width_m) continue;
    Door door;
    door.a = opening.a;
    door.b = opening.b;
    const double from_shape = std::log(opening.probability / std::max(1e-6, 1 - opening.probability));
    const double from_sightings = kEvidencePerSighting * support[k];
    door.evidence = std::min(kMaxEvidence, from_shape + from_sightings);
    if (door.evidence < options.least_evidence) continue;
    door.region_a = cut.left;
    door.region_b = cut.right;
    doors.push_back(door);
  }
  return doors;
}

}  // namespace modslam
