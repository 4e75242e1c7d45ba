// SPDX-License-Identifier: BSD-3-Clause
/// @file A long path in few points.
#pragma once
#include "viewer/trail.hpp"

namespace modslam {

/// Draws a path into a trail as a line that keeps within a tolerance of it. More than kMost points double the tolerance: a long path is
/// kept whole, only coarser. A point costs O(1).
/// Source: the sleeve-fitting of Zhao and Saalfeld, "Linear-time sleeve-fitting polyline simplification algorithms", AutoCarto 1997.
class PathSketch {
 public:
  static constexpr std::size_t kMost = 2000;
  static constexpr double kFinest_m = 0.01;

  explicit PathSketch(Trail& trail) : trail_(trail) {}

  /// Goes on to a place [m], heading [rad].
  void add(const Triple& place);
  void clear();
  double tolerance_m() const { return tolerance_m_; }

 private:
  bool goes_on(const Triple& place);
  void coarsen();

  Trail& trail_;
  double tolerance_m_ = kFinest_m;
  bool stretching_ = false;  ///< the last point may still move
  /// Of the line from the last point but one: lines to the places in this sleeve pass all others between. Angles [rad] from `direction_rad_`.
  double direction_rad_ = 0, low_rad_ = 0, high_rad_ = 0, length_m_ = 0;
};

}  // namespace modslam
