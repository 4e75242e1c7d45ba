// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/path_sketch.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

double apart_m(const Triple& a, const Triple& b) { return std::hypot(b[0] - a[0], b[1] - a[1]); }
double direction(const Triple& from, const Triple& to) { return std::atan2(to[1] - from[1], to[0] - from[0]); }

}  // namespace

void PathSketch::add(const Triple& place) {
  if (trail_.triples().empty()) return trail_.append(place);
  if (apart_m(trail_.triples().back(), place) < tolerance_m_) return;
  if (stretching_ && goes_on(place)) return;
  const Triple& corner = trail_.triples().back();
  direction_rad_ = direction(corner, place);
  length_m_ = apart_m(corner, place);
  high_rad_ = std::asin(std::min(1.0, tolerance_m_ / length_m_));
  low_rad_ = -high_rad_;
  stretching_ = true;
  trail_.append(place);
  if (trail_.triples().size() > kMost) coarsen();
}

/// Moves the last point there if the line to it still passes all places since the last corner.
bool PathSketch::goes_on(const Triple& place) {
  const std::size_t last = trail_.triples().size() - 1;
  const Triple& corner = trail_.triples()[last - 1];
  const double length_m = apart_m(corner, place), angle_rad = wrap_angle(direction(corner, place) - direction_rad_);
  if (length_m < length_m_ || angle_rad < low_rad_ || angle_rad > high_rad_) return false;
  const double half_rad = std::asin(std::min(1.0, tolerance_m_ / length_m));
  low_rad_ = std::max(low_rad_, angle_rad - half_rad);
  high_rad_ = std::min(high_rad_, angle_rad + half_rad);
  length_m_ = length_m;
  trail_.set(last, place);
  return true;
}

void PathSketch::coarsen() {
  const std::vector<Triple> places = trail_.triples();
  tolerance_m_ *= 2;
  stretching_ = false;
  trail_.start_over();
  for (const Triple& place : places) add(place);
}

void PathSketch::clear() {
  trail_.clear();
  tolerance_m_ = kFinest_m;
  stretching_ = false;
}

}  // namespace modslam
