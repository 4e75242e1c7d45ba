// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/map_annotator.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/semantics/evidence_grid.hpp"
#include "common/semantics/floor.hpp"
#include "common/semantics/identities.hpp"
#include "common/semantics/interpret.hpp"

namespace modslam {
namespace {

constexpr double kCell_m = 0.05, kRange_m = 12.0, kApart_m = 1.0, kRoom_m = 0.25;
constexpr double kFringe_m = 0.15;  // unknown cells that a beam crosses: smoothed maps have them between floor and wall
constexpr int kBeams = 360;
constexpr double kWallBeside_m = 0.15, kMostOpen = 0.02;  // a robot's maps have 0.05 to 0.2 unless it saw all, plans below 0.005

/// What a laser at `eye` would measure in the map; 0 where a beam meets nothing.
Scan look_around(const KnownSpace& space, const Eigen::Vector2d& eye) {
  Scan scan;
  scan.rad0 = -kPi;
  scan.radstep = 2 * kPi / kBeams;
  const Eigen::Vector2d from = (eye - space.origin_m) / space.resolution_m;
  for (int k = 0; k < kBeams; ++k) {
    const double bearing = scan.bearing_rad(static_cast<std::size_t>(k));
    const Eigen::Vector2d d(std::cos(bearing), std::sin(bearing));
    double range_m = 0, known = 0;
    for (double s = 1; s * space.resolution_m < kRange_m; s += 0.5) {
      const Eigen::Vector2d p = from + s * d;
      const cv::Point c(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())));
      if (!space.inside(c) || (s - known) * space.resolution_m > kFringe_m) break;
      if (space.occupancy(c) > 0) known = s;
      if (space.occupancy(c) < 128) continue;
      // The cell's centre, seen along the beam: the map says no more.
      range_m = d.dot(space.centre(c) - eye);
      break;
    }
    scan.ranges_m.push_back(static_cast<float>(range_m));
  }
  return scan;
}

/// The roomiest cell of every square of the floor that a robot would fit into.
std::vector<Eigen::Vector2d> places(const Floor& floor, const KnownSpace& space) {
  const int square = static_cast<int>(kApart_m / space.resolution_m);
  std::vector<Eigen::Vector2d> out;
  for (int y = 0; y < floor.open.rows; y += square)
    for (int x = 0; x < floor.open.cols; x += square) {
      const cv::Rect box = cv::Rect(x, y, square, square) & cv::Rect(0, 0, floor.open.cols, floor.open.rows);
      cv::Mat1f clearance = floor.clearance(box).clone();
      clearance.setTo(0, floor.solid(box));
      double most = 0;
      cv::Point at;
      cv::minMaxLoc(clearance, nullptr, &most, nullptr, &at);
      if (most * space.resolution_m >= kRoom_m) out.push_back(space.centre(at + box.tl()));
    }
  return out;
}

}  // namespace

double open_rim(const KnownSpace& space) {
  if (space.empty()) return 0;
  cv::Mat free, solid, world, rim, open;
  cv::inRange(space.occupancy, 1, 127, free);
  cv::inRange(space.occupancy, 128, 255, solid);
  // From a corner on: around the map nothing is known.
  cv::inRange(space.occupancy, 0, 0, world);
  cv::copyMakeBorder(world, world, 1, 1, 1, 1, cv::BORDER_CONSTANT, 255);
  cv::floodFill(world, cv::Point(0, 0), cv::Scalar(1));
  cv::inRange(world(cv::Rect(cv::Point(1, 1), free.size())), 1, 1, world);
  const auto beside = [](const cv::Mat& mask, int cells) {
    cv::Mat out;
    cv::dilate(mask, out, cv::getStructuringElement(cv::MORPH_RECT, {2 * cells + 1, 2 * cells + 1}));
    return out;
  };
  cv::bitwise_not(free, rim);
  cv::bitwise_and(free, beside(rim, 1), rim);
  cv::bitwise_and(rim, beside(world, 1), open);
  open.setTo(0, beside(solid, static_cast<int>(std::lround(kWallBeside_m / space.resolution_m))));
  const int cells = cv::countNonZero(rim);
  return cells > 0 ? static_cast<double>(cv::countNonZero(open)) / cells : 0;
}

OpeningModel::Kind kind_of(const KnownSpace& space) { return open_rim(space) > kMostOpen ? OpeningModel::Kind::kSensed : OpeningModel::Kind::kFinished; }

AnnotatedMap annotate(const MapImage& map, const SemanticsConfig& config) {
  AnnotatedMap out{{}, KnownSpace(map, kCell_m)};
  if (out.space.empty()) return out;
  const Floor floor = make_floor(out.space, config.object_max_m2);
  SensorInfo sensor;
  sensor.range_max_m = kRange_m;
  EvidenceGrid grid(kCell_m);
  Interpreter interpreter(config, kind_of(out.space));
  HoughOptions hough;
  hough.min_length_m = config.line_min_m;
  DoorSensorOptions doors;
  doors.min_width_m = config.door_min_m;
  doors.max_width_m = config.door_max_m;
  for (const Eigen::Vector2d& eye : places(floor, out.space)) {
    const Scan scan = look_around(out.space, eye);
    const Pose2 T_map_base(eye.x(), eye.y(), 0);
    std::vector<ScanPoint> points = points_base(scan, sensor);
    for (ScanPoint& point : points) point.p = T_map_base * point.p;
    const LineExtraction lines = extract_lines(points, eye, scan.radstep, hough);
    for (std::size_t k = 0; k < points.size(); ++k) grid.add(points[k].p, lines.on_segment[k], 1);
    for (const Segment& segment : lines.segments) interpreter.add(segment, 1);
    for (const DoorSighting& s : sight_doors(scan, sensor, doors)) interpreter.add(DoorSighting{T_map_base * s.a, T_map_base * s.b}, 1);
  }
  const Boxes all{cv::Rect({0, 0}, out.space.occupancy.size())};
  interpreter.update(out.space, all, [&grid](const Eigen::Vector2d& p) { return grid.log_odds(p); }, {}, out.layers);
  Identities().carry_over({}, out.layers);
  return out;
}

}  // namespace modslam
