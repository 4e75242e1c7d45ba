// SPDX-License-Identifier: BSD-3-Clause
#include "common/places/panorama.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr std::size_t kPast = 30;      // scans before
constexpr double kPastWay_m = 8.0;     // and no farther back: what was seen there was seen from somewhere else
constexpr double kBin_rad = 2 * kPi / kPanoramaBins;
constexpr float kUnknown = -1;

using Bins = std::array<float, kPanoramaBins>;

/// The beam that looks nearest to a bearing of the laser frame, or -1 beside the field of view.
int beam_at(const Scan& scan, double bearing_rad) {
  const double step = std::abs(scan.radstep) > 1e-9 ? scan.radstep : kBin_rad;
  const double middle_rad = scan.rad0 + 0.5 * step * static_cast<double>(scan.ranges_m.size() - 1);
  const double beam = std::round((wrap_angle(bearing_rad - middle_rad) + middle_rad - scan.rad0) / step);
  return beam >= 0 && beam < static_cast<double>(scan.ranges_m.size()) ? static_cast<int>(beam) : -1;
}

/// What the scan itself tells; beams without return tell at least how far the laser reaches.
struct OwnView {
  Bins range_m, at_least_m;
  std::vector<Eigen::Vector2d> points;  ///< frame of the robot, the laser's place its origin kept
};

OwnView look(const Scan& scan, const SensorInfo& sensor) {
  OwnView view;
  view.range_m.fill(kUnknown);
  view.at_least_m.fill(kUnknown);
  if (scan.ranges_m.empty()) return view;
  const auto reach_m = static_cast<float>(std::min(sensor.range_max_m, kPanoramaReach_m));
  for (std::size_t k = 0; k < kPanoramaBins; ++k) {
    const double bearing = kBin_rad * static_cast<double>(k);
    const int beam = beam_at(scan, bearing - sensor.T_base_laser.heading);
    if (beam < 0) continue;
    const float range_m = scan.ranges_m[static_cast<std::size_t>(beam)];
    if (!is_return(range_m, sensor)) {
      view.at_least_m[k] = reach_m;
      continue;
    }
    view.range_m[k] = std::min(range_m, static_cast<float>(kPanoramaReach_m));
    if (range_m < kPanoramaReach_m && k % 2 == 0)  // of the past every other degree is enough
      view.points.push_back(sensor.T_base_laser.translation() + static_cast<double>(range_m) * Eigen::Vector2d(std::cos(bearing), std::sin(bearing)));
  }
  return view;
}

/// A bin that nobody saw lies on the line between the nearest that somebody did.
void bridge(Bins& bins) {
  const auto first = std::find_if(bins.begin(), bins.end(), [](float r) { return r >= 0; });
  if (first == bins.end()) {
    bins.fill(static_cast<float>(kPanoramaReach_m));
    return;
  }
  const std::size_t start = static_cast<std::size_t>(first - bins.begin());
  std::size_t last = start;  // the newest known one, counted from start around
  for (std::size_t n = start + 1; n <= start + kPanoramaBins; ++n) {
    const float here = bins[n % kPanoramaBins];
    if (here < 0) continue;
    const float before = bins[last % kPanoramaBins];
    for (std::size_t m = last + 1; m < n; ++m)
      bins[m % kPanoramaBins] = before + (here - before) * static_cast<float>(m - last) / static_cast<float>(n - last);
    last = n;
  }
}

}  // namespace

Panorama PanoramaMaker::add(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) {
  OwnView own = look(scan, sensor);
  Panorama out;
  out.range_m = own.range_m;
  const double step_m = past_.empty() ? 0 : distance(past_.front().T_map_base, T_map_base);
  for (View& view : past_) view.way_m += step_m;
  while (!past_.empty() && (past_.size() >= kPast || past_.back().way_m > kPastWay_m)) past_.pop_back();
  Bins seen;  // by the past, from here
  seen.fill(kUnknown);
  const Eigen::Vector2d eye = sensor.T_base_laser.translation();
  for (const View& view : past_) {
    const PointMover here(between(T_map_base, view.T_map_base));
    for (const Eigen::Vector2d& point : view.points) {
      const Eigen::Vector2d d = here * point - eye;
      const auto bin = static_cast<std::size_t>(std::lround(std::atan2(static_cast<float>(d.y()), static_cast<float>(d.x())) / kBin_rad) + static_cast<long>(kPanoramaBins)) % kPanoramaBins;
      const auto range_m = static_cast<float>(std::min(d.norm(), kPanoramaReach_m));
      if (out.range_m[bin] >= 0 || range_m < own.at_least_m[bin]) continue;
      if (seen[bin] < 0 || range_m < seen[bin]) seen[bin] = range_m;
    }
  }
  int known = 0;
  for (std::size_t k = 0; k < kPanoramaBins; ++k) {
    if (out.range_m[k] < 0) out.range_m[k] = seen[k];
    if (out.range_m[k] < 0 && own.at_least_m[k] >= 0) out.range_m[k] = static_cast<float>(kPanoramaReach_m);
    known += out.range_m[k] >= 0;
  }
  out.known = static_cast<double>(known) / static_cast<double>(kPanoramaBins);
  bridge(out.range_m);
  past_.push_front({T_map_base, std::move(own.points), 0});
  return out;
}

}  // namespace modslam
