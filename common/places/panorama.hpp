// SPDX-License-Identifier: BSD-3-Clause
/// @file How far one can see all around a node: its own scan where the laser looks, and what the scans just before saw elsewhere. Beam
/// count, field of view and reach of the laser are gone from it.
#pragma once
#include <array>
#include <deque>
#include <vector>

#include "common/scan/scan.hpp"

namespace modslam {

constexpr std::size_t kPanoramaBins = 360;
constexpr double kPanoramaReach_m = 20.0;  ///< what is farther counts as that far

struct Panorama {
  std::array<float, kPanoramaBins> range_m{};  ///< from the laser; bin k looks to k degrees, frame of the robot; gaps are bridged
  double known = 0;                            ///< share of the bins that some scan saw
};

/// Takes the nodes of a path in order.
class PanoramaMaker {
 public:
  Panorama add(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base);
  void clear() { past_.clear(); }

 private:
  struct View {
    Pose2 T_map_base;
    std::vector<Eigen::Vector2d> points;  ///< frame of the robot
    double way_m;                         ///< driven since, in straight steps from node to node
  };
  std::deque<View> past_;  ///< newest first
};

}  // namespace modslam
