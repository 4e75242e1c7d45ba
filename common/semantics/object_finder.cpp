// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/object_finder.hpp"

#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

constexpr double kMinArea_m2 = 0.03;
constexpr double kWallThickness_m = 0.5, kWallExtent_m = 1.2;  // thin and long: a piece of wall between two doors

/// A guess from the footprint's size and shape; "" when several would do.
std::string guess_class(double area_m2, const cv::RotatedRect& box, double resolution_m) {
  const double a = std::max(box.size.width, box.size.height) * resolution_m, b = std::min(box.size.width, box.size.height) * resolution_m;
  if (a > 3.5 && a < 5.6 && b > 1.4 && b < 2.6) return "car";
  if (area_m2 < 0.4 && a < 0.8 && b > 0.6 * a) return "pillar";
  return "";
}

}  // namespace

ObjectMap find_objects(const KnownSpace& space, double max_m2) {
  ObjectMap out;
  if (space.empty()) return out;
  out.mask = cv::Mat1b(space.occupancy.size(), std::uint8_t{0});
  cv::Mat1b free, solid;
  cv::inRange(space.occupancy, 1, 127, free);
  cv::bitwise_not(free, solid);
  cv::Mat1i labels, statistics;
  cv::Mat1d centres;
  const int count = cv::connectedComponentsWithStats(solid, labels, statistics, centres, 8, CV_32S);
  const double cell_m2 = space.resolution_m * space.resolution_m;
  for (int k = 1; k < count; ++k) {
    const cv::Rect box(statistics(k, cv::CC_STAT_LEFT), statistics(k, cv::CC_STAT_TOP), statistics(k, cv::CC_STAT_WIDTH),
                       statistics(k, cv::CC_STAT_HEIGHT));
    const double area_m2 = statistics(k, cv::CC_STAT_AREA) * cell_m2;
    const bool at_border = box.x == 0 || box.y == 0 || box.br().x == solid.cols || box.br().y == solid.rows;
    if (at_border || area_m2 < kMinArea_m2 || area_m2 > max_m2) continue;
    cv::Mat1b mask;
    cv::inRange(labels(box), k, k, mask);
    const bool thin = thickness_m(mask, space.resolution_m) < kWallThickness_m;
    if (thin && std::max(box.width, box.height) * space.resolution_m > kWallExtent_m) continue;
    cv::Mat1b hit;
    cv::inRange(space.occupancy(box), 128, 255, hit);
    cv::bitwise_and(hit, mask, hit);
    if (cv::countNonZero(hit) == 0) continue;  // a shadow, nothing that was touched by a beam
    KnownSpace part = space;
    part.origin_m += space.resolution_m * Eigen::Vector2d(box.x, box.y);
    Object object;
    object.outline = outline_of(mask, part, 1e9, 0.1);
    if (object.outline.size() < 3) continue;
    std::vector<cv::Point> cells;
    cv::findNonZero(mask, cells);
    object.area_m2 = area_m2;
    object.class_name = guess_class(area_m2, cv::minAreaRect(cells), space.resolution_m);
    object.evidence = static_cast<double>(cv::countNonZero(hit)) / static_cast<double>(cells.size());
    out.objects.push_back(object);
    out.mask(box).setTo(255, mask);
  }
  return out;
}

}  // namespace modslam
