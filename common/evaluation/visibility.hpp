// SPDX-License-Identifier: BSD-3-Clause
/// @file What of a true world a run could see: a map is not to blame for what no beam has touched.
#pragma once
#include <map>
#include <vector>

#include "common/evaluation/semantic_map.hpp"
#include "common/scan/scan.hpp"

namespace modslam {

/// A sweep at its true place.
struct PlacedScan {
  Pose2 T_world_laser;
  Scan scan;
  SensorInfo sensor;
};

/// A point every 5 cm along a wall, in the middle of its piece, standing for `length_m` of it.
struct WallSample {
  Eigen::Vector2d p;
  std::size_t wall;
  double length_m;
};
std::vector<WallSample> sample_walls(const std::vector<MapWall>& walls);

/// Distance to the segment, or to the nearer face of a thick wall.
double distance_to_wall(const Eigen::Vector2d& point, const MapWall& wall);

/// Space that beams have crossed, in cells of 0.1 m of the world frame.
class SeenSpace {
 public:
  void add_beam(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  bool crossed(const Eigen::Vector2d& place) const;
  /// Share of the polygon's cells, outside of `objects`, that were crossed; 0 when it covers no
  /// cell.
  double share(const MapPolygon& polygon, const std::vector<MapObject>& objects) const;

 private:
  std::map<std::pair<int, int>, std::vector<bool>> tiles_;
};

struct Visibility {
  std::vector<bool> wall_samples;  ///< of sample_walls(truth.walls): a beam ended within 0.1 m
  std::vector<bool>
      doors;  ///< a beam crossed the opening, or beams ended within 0.1 m of both jambs
  std::vector<double> rooms_explored;  ///< 0..1
  SeenSpace seen;
  bool from_run = false;  ///< false: everything counts as seen
};
Visibility everything_visible(const SemanticMap& truth);
Visibility visible_in(const SemanticMap& truth, const std::vector<PlacedScan>& scans);

}  // namespace modslam
