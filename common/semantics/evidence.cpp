// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/evidence.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {
constexpr double kShortOfHit_m = 0.12;  // a beam proves nothing about the last piece before its end
constexpr std::size_t kMaxFreeBeams = 400;  // denser beams cross the same cells
}  // namespace

EvidenceScan make_evidence(const Scan& scan, const SensorInfo& sensor, double range_limit_m,
                           const LineExtractionParameters& lines) {
  EvidenceScan out;
  out.T_base_laser = sensor.T_base_laser;
  std::vector<ScanPoint> near;
  for (const ScanPoint& point : points_base(scan, sensor))
    if (point.range_m <= range_limit_m) near.push_back(point);
  out.classified = extract_lines(near, scan.radstep, lines);
  const std::size_t stride = 1 + scan.ranges_m.size() / (kMaxFreeBeams + 1);
  for (std::size_t i = 0; i < scan.ranges_m.size(); i += stride) {
    const float range = scan.ranges_m[i];
    const bool nothing = !is_return(range, sensor);
    if (nothing && !(sensor.no_return_is_free && (range >= sensor.range_max_m || range <= 0)))
      continue;
    const double proven =
        nothing ? std::min(sensor.range_max_m, range_limit_m) : range - kShortOfHit_m;
    if (proven > 0)
      out.free_beams.push_back({static_cast<float>(scan.bearing_rad(i)),
                                static_cast<float>(std::min(proven, range_limit_m))});
  }
  return out;
}

void Evidence::clear() {
  hits_.clear();
  free_.clear();
}

int Evidence::crossings(const Eigen::Vector2d& place) const {
  const std::int32_t* cell = free_.find(free_.index(place.x()), free_.index(place.y()));
  return cell ? *cell : 0;
}

void Evidence::add(const EvidenceScan& scan, const Pose2& T_map_base, int sign) {
  const ClassifiedScan& classified = scan.classified;
  std::vector<std::pair<int, int>> directions;
  for (const Segment& segment : classified.segments) {
    const Eigen::Vector2d d = segment.b - segment.a;
    const double twice = 2 * (std::atan2(d.y(), d.x()) + T_map_base.heading);
    directions.emplace_back(std::lround(100 * std::cos(twice)), std::lround(100 * std::sin(twice)));
  }
  const Pose2 T_map_laser = T_map_base * scan.T_base_laser;
  for (std::size_t i = 0; i < classified.points.size(); ++i) {
    const Eigen::Vector2d p = T_map_base * classified.points[i];
    const int ix = hits_.index(p.x()), iy = hits_.index(p.y());
    HitCell& cell = hits_.at(ix, iy);
    cell.dx_mm += sign * static_cast<int>(std::lround(1000 * (p.x() - hits_.centre_m(ix))));
    cell.dy_mm += sign * static_cast<int>(std::lround(1000 * (p.y() - hits_.centre_m(iy))));
    const Eigen::Vector2d view = (T_map_laser.translation() - p).normalized();
    cell.view_x += sign * static_cast<int>(std::lround(100 * view.x()));
    cell.view_y += sign * static_cast<int>(std::lround(100 * view.y()));
    const int segment = classified.segment_of[i];
    (segment >= 0 ? cell.wall : cell.object) += sign;
    if (segment < 0) continue;
    cell.cos2 += sign * directions[static_cast<std::size_t>(segment)].first;
    cell.sin2 += sign * directions[static_cast<std::size_t>(segment)].second;
  }
  for (const FreeBeam& beam : scan.free_beams) {
    const double angle = T_map_laser.heading + beam.bearing_rad;
    const Eigen::Vector2d from = T_map_laser.translation();
    trace(from, from + beam.length_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)), sign);
  }
}

/// Amanatides and Woo 1987: every cell that the line enters.
void Evidence::trace(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int sign) {
  const double scale = 1.0 / free_.resolution_m();
  const double x = from.x() * scale, y = from.y() * scale;
  const double dx = to.x() * scale - x, dy = to.y() * scale - y;
  int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  const int end_x = static_cast<int>(std::floor(x + dx)),
            end_y = static_cast<int>(std::floor(y + dy));
  const int step_x = dx > 0 ? 1 : -1, step_y = dy > 0 ? 1 : -1;
  const double delta_x = dx != 0 ? std::abs(1 / dx) : 1e18,
               delta_y = dy != 0 ? std::abs(1 / dy) : 1e18;
  double next_x = dx != 0 ? (dx > 0 ? ix + 1 - x : x - ix) * delta_x : 1e18;
  double next_y = dy != 0 ? (dy > 0 ? iy + 1 - y : y - iy) * delta_y : 1e18;
  for (int left = std::abs(end_x - ix) + std::abs(end_y - iy); left >= 0; --left) {
    free_.at(ix, iy) += sign;
    if (next_x < next_y) {
      next_x += delta_x;
      ix += step_x;
    } else {
      next_y += delta_y;
      iy += step_y;
    }
  }
}

}  // namespace modslam
