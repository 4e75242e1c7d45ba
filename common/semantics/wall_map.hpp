// SPDX-License-Identifier: BSD-3-Clause
/// @file Walls from the segments of many scans: the segment merging of the thesis (algorithm 4), done with sums.
///
/// Segments that lie on one line, seen from one side, join a band. A band keeps the sums of its points (so its line is the least-squares line
/// of all of them) and where along it segments lay; a wall is a stretch that enough scans have seen.
#pragma once
#include <functional>
#include <vector>

#include "common/semantics/hough.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct WallMapOptions {
  double join_rad = 0.09;      ///< largest angle between a segment and the band it joins
  double join_m = 0.09;        ///< largest distance of the segment's middle from the band
  double band_gap_m = 3.0;     ///< longest gap along one band
  double bridge_m = 0.25;      ///< gaps this short inside a wall are closed
  double min_length_m = 0.5;
  int min_sightings = 2;       ///< scans that must have seen a stretch
};

/// Segments of one scan, placed in the map.
using PlacedSegments = std::vector<Segment>;

/// Walls of one band, in order along it. Gaps between neighbours are where doors are looked for.
struct WallBand {
  std::vector<Wall> walls;
};

/// @param scans segments of each scan in the map frame. @param is_solid whether the raster knows something solid around a place: a stretch
/// that most beams passed is no wall, whoever drew a line across it. Cost O(segments * bands of like direction). Same input, same order out.
std::vector<WallBand> merge_segments(const std::vector<PlacedSegments>& scans, const WallMapOptions& options,
                                     const std::function<bool(const Eigen::Vector2d&)>& is_solid);

}  // namespace modslam
