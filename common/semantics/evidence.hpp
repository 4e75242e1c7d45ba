// SPDX-License-Identifier: BSD-3-Clause
/// @file Evidence of all scans, laid into the map: which cells were hit as wall or as something
/// else, which were crossed.
///
/// All sums are integers, so that taking a scan out again restores exactly what was there before:
/// after a loop closure only the scans that moved are taken out and put in again.
#pragma once
#include "common/scan/scan.hpp"
#include "common/semantics/line_extraction.hpp"
#include "common/semantics/tile_grid.hpp"

namespace modslam {

/// What ended in a cell.
struct HitCell {
  std::int32_t wall = 0,
               object = 0;  ///< beams that ended here, on a straight piece of their scan or not
  std::int32_t dx_mm = 0, dy_mm = 0;  ///< sums of their places relative to the centre of the cell
  std::int32_t cos2 = 0,
               sin2 =
                   0;  ///< sums of 100 cos, 100 sin of twice the direction of the straight pieces

  std::int32_t view_x = 0, view_y = 0;  ///< sums of 100 times the unit vector towards the sensor

  int hits() const { return wall + object; }
};

/// Direction of a beam and the length to which it proves free space, base frame.
struct FreeBeam {
  float bearing_rad, length_m;
};

/// A scan as evidence: classified points, free beams.
struct EvidenceScan {
  ClassifiedScan classified;
  std::vector<FreeBeam> free_beams;
  Pose2 T_base_laser;
};
/// Returns beyond range_limit_m are free space up to there and no points.
EvidenceScan make_evidence(const Scan& scan, const SensorInfo& sensor, double range_limit_m,
                           const LineExtractionParameters& lines);

class Evidence {
 public:
  static constexpr int kFreeFactor = 2;  ///< free space is counted in cells this many times coarser

  explicit Evidence(double resolution_m) : hits_(resolution_m), free_(resolution_m * kFreeFactor) {}

  void insert(const EvidenceScan& scan, const Pose2& T_map_base) { add(scan, T_map_base, 1); }
  /// Exact inverse of insert with the same arguments.
  void remove(const EvidenceScan& scan, const Pose2& T_map_base) { add(scan, T_map_base, -1); }
  void clear();

  const TileGrid<HitCell>& hits() const { return hits_; }
  const TileGrid<std::int32_t>& free() const { return free_; }
  /// Beams that crossed the place.
  int crossings(const Eigen::Vector2d& place) const;

 private:
  void add(const EvidenceScan& scan, const Pose2& T_map_base, int sign);
  void trace(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int sign);

  TileGrid<HitCell> hits_;
  TileGrid<std::int32_t> free_;
};

}  // namespace modslam
