// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/oriented_points.hpp"

#include <algorithm>

namespace modslam {
namespace {

constexpr int kNeighbours = 4;           // beams looked at on each side
constexpr double kJump_m = 0.20;         // two neighbours farther apart lie on different surfaces...
constexpr double kJumpSpacings = 6.0;    // ...unless the beams themselves are that far apart
constexpr double kMaxResidual_m = 0.03;  // rms of points that are still one straight surface

/// First and last index around `i` that lie on the same surface.
std::pair<std::size_t, std::size_t> surface(const std::vector<ScanPoint>& points, std::size_t i,
                                            double radstep) {
  const auto connected = [&](std::size_t a, std::size_t b) {
    if (std::abs(points[b].beam - points[a].beam) > 2) return false;
    const double reach = std::max(kJump_m, kJumpSpacings * radstep * points[i].range_m);
    return (points[a].p - points[b].p).squaredNorm() < reach * reach;
  };
  std::size_t first = i, last = i;
  while (first > 0 && i - first < kNeighbours && connected(first, first - 1)) --first;
  while (last + 1 < points.size() && last - i < kNeighbours && connected(last, last + 1)) ++last;
  return {first, last};
}

}  // namespace

std::vector<OrientedPoint> orient(const Scan& scan, const SensorInfo& sensor, const RangeNoise& noise,
                                  double range_limit_m, double spacing_m) {
  const std::vector<ScanPoint> points = points_base(scan, sensor);
  const Eigen::Vector2d eye = sensor.T_base_laser.translation();
  const double var_range = noise.sigma_range_m * noise.sigma_range_m;
  std::vector<OrientedPoint> oriented;
  oriented.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ScanPoint& point = points[i];
    if (point.range_m > range_limit_m) continue;
    if (!oriented.empty() && (oriented.back().p - point.p).squaredNorm() < spacing_m * spacing_m) continue;
    OrientedPoint out{point.p, Eigen::Vector2d::Zero(), static_cast<float>(var_range), 0.0F};

    const auto [first, last] = surface(points, i, std::abs(scan.radstep));
    const double count = static_cast<double>(last - first + 1);
    if (count >= 3) {
      Eigen::Vector2d mean = Eigen::Vector2d::Zero();
      for (std::size_t k = first; k <= last; ++k) mean += points[k].p;
      mean /= count;
      double xx = 0, xy = 0, yy = 0;
      for (std::size_t k = first; k <= last; ++k) {
        const Eigen::Vector2d d = points[k].p - mean;
        xx += d.x() * d.x();
        xy += d.x() * d.y();
        yy += d.y() * d.y();
      }
      // Principal axes of the scatter matrix in closed form.
      const double along_rad = 0.5 * std::atan2(2 * xy, xx - yy);
      const double half_trace = 0.5 * (xx + yy), half_spread = std::hypot(0.5 * (xx - yy), xy);
      const double along2 = half_trace + half_spread, across2 = std::max(0.0, half_trace - half_spread);
      if (across2 / count < kMaxResidual_m * kMaxResidual_m && across2 < 0.1 * along2) {
        out.n = {-std::sin(along_rad), std::cos(along_rad)};
        const Eigen::Vector2d beam = (point.p - eye).normalized();
        if (out.n.dot(beam) > 0) out.n = -out.n;
        const double c = out.n.dot(beam), across_beam = point.range_m * noise.sigma_bearing_rad;
        out.var_m2 = static_cast<float>(var_range * c * c + across_beam * across_beam * (1 - c * c));
        out.var_normal_rad2 = static_cast<float>(var_range / along2);
      }
    }
    oriented.push_back(out);
  }
  return oriented;
}

}  // namespace modslam
