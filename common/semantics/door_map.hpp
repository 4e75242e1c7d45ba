// SPDX-License-Identifier: BSD-3-Clause
/// @file Doors: the openings between rooms that are as wide as doors, with what scans saw of them over time (thesis 3.4.3).
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/semantics/door_sensor.hpp"
#include "common/semantics/partition.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct DoorMapOptions {
  double min_width_m = 0.6, max_width_m = 1.7;
  double centre_m = 0.35;  ///< a sighting supports an opening whose centre is this near
  double least_evidence = 3;  ///< log-odds; a less sure cut parts rooms, but is not listed as a door
};

/// What scans saw of openings, by the square of the floor that their centres lie in, so that a door looks only around itself.
class DoorSightings {
 public:
  /// Map frame; sign -1 takes it back.
  void add(const DoorSighting& sighting, int sign);
  /// How many sightings say the same as each cut's opening. Counted are those of cuts that were not asked about in the last call, or near which sightings came or went.
  std::vector<int> support(const std::vector<CutOpening>& cuts, double centre_m);

 private:
  /// The count for a cut in the round when it was asked for.
  struct Known {
    Eigen::Vector2d a{0, 0}, b{0, 0};
    int round = 0, count = 0;
  };
  int count(const Gap& opening, double centre_m) const;
  bool is_stirred(const Gap& opening, double centre_m) const;

  std::unordered_map<std::int64_t, std::vector<DoorSighting>> squares_;
  std::vector<Eigen::Vector2d> stirred_;   ///< centres of sightings that came or went since the last call
  std::vector<Known> known_;               ///< by number of the cut
  int round_ = 0;
};

/// @param sightings each adds to the evidence of the door it saw.
std::vector<Door> find_doors(const Partition& partition, DoorSightings& sightings, const DoorMapOptions& options);
std::vector<Door> find_doors(const Partition& partition, const std::vector<DoorSighting>& sightings, const DoorMapOptions& options);

}  // namespace modslam
