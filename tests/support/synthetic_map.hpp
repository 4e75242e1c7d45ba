// SPDX-License-Identifier: BSD-3-Clause
/// @file What map builder and classifier would say of the synthetic building.
#pragma once
#include <map>
#include <modslam/map_tile_t.hpp>
#include <utility>
#include <vector>

#include "common/bus/log.hpp"
#include "common/scan/scan.hpp"

namespace modslam::test {

/// Counts of hits and passes on a lattice of the map frame.
class Canvas {
 public:
  void add(const Pose2& T_map_laser, const Scan& scan);
  std::vector<map_tile_t> tiles(std::int64_t utime) const;

 private:
  void touch(double x, double y, bool hit);
  std::map<std::pair<int, int>, std::vector<double>> odds_;
};

/// Walls, rooms, doors and objects; the walls in two chunks, the later one first: order must not matter.
void write_semantics(LogWriter& log, std::int64_t utime, const Pose2& T_map_world);

}  // namespace modslam::test
