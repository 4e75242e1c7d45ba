// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/floor.hpp"

#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

constexpr double kSmall_m = 1.0;          // islands no longer than this are things, whatever their shape
constexpr double kWallThickness_m = 0.5;  // longer ones are pieces of wall when they are thinner than this ...
constexpr double kCompact = 0.85;          // ... or fill less of their box: a cupboard stands against the piece
constexpr double kRay_m = 0.2;              // floor is at least this wide
constexpr double kFan_m = 0.5, kNearSolid_m = 0.25;  // ... and at least this where nothing was hit near by: beams through a door spread like a fan
constexpr double kSpeck_m2 = 1.0;  // smaller patches of floor on their own say nothing

double share_of_box(const cv::Mat1b& mask) {
  std::vector<cv::Point> cells;
  cv::findNonZero(mask, cells);
  const cv::Size2f size = cv::minAreaRect(cells).size;
  return static_cast<double>(cells.size()) / ((size.width + 1) * (size.height + 1));
}

}  // namespace

Floor make_floor(const KnownSpace& space, double island_max_m2) {
  Floor floor;
  floor.resolution_m = space.resolution_m;
  if (space.empty()) return floor;
  cv::inRange(space.occupancy, 1, 127, floor.open);
  cv::inRange(space.occupancy, 128, 255, floor.solid);
  cv::Mat1b closed;
  cv::bitwise_not(floor.open, closed);
  cv::Mat1i labels, statistics;
  cv::Mat1d centres;
  const int count = cv::connectedComponentsWithStats(closed, labels, statistics, centres, 8, CV_32S);
  const double cell_m2 = space.resolution_m * space.resolution_m;
  for (int k = 1; k < count; ++k) {
    const cv::Rect box(statistics(k, cv::CC_STAT_LEFT), statistics(k, cv::CC_STAT_TOP), statistics(k, cv::CC_STAT_WIDTH),
                       statistics(k, cv::CC_STAT_HEIGHT));
    const bool at_border = box.x == 0 || box.y == 0 || box.br().x == closed.cols || box.br().y == closed.rows;
    if (at_border || statistics(k, cv::CC_STAT_AREA) * cell_m2 > island_max_m2) continue;
    cv::Mat1b mask;
    cv::inRange(labels(box), k, k, mask);
    const bool small = std::max(box.width, box.height) * space.resolution_m <= kSmall_m;
    const bool thing = small || (thickness_m(mask, space.resolution_m) >= kWallThickness_m && share_of_box(mask) >= kCompact);
    if (thing) floor.open(box).setTo(255, mask);
  }
  // Single beams through a gap leave rays; what is thinner than a hand's breadth is none of the floor.
  const auto disc = [&](double width_m) {
    const int cells = 2 * static_cast<int>(std::lround(width_m / space.resolution_m / 2)) + 1;
    return cv::getStructuringElement(cv::MORPH_ELLIPSE, {cells, cells});
  };
  cv::morphologyEx(floor.open, floor.open, cv::MORPH_OPEN, disc(kRay_m));
  const auto square = [&](double width_m) {
    const int cells = 2 * static_cast<int>(std::lround(width_m / space.resolution_m / 2)) + 1;
    return cv::getStructuringElement(cv::MORPH_RECT, {cells, cells});
  };
  cv::Mat1b broad;
  cv::dilate(floor.solid, broad, square(2 * kNearSolid_m));
  cv::bitwise_or(broad, floor.open, broad);
  cv::morphologyEx(broad, broad, cv::MORPH_OPEN, square(kFan_m));
  cv::bitwise_and(floor.open, broad, floor.open);
  // Beams that slipped through a window leave single cells and threads beyond it.
  const int specks = cv::connectedComponentsWithStats(floor.open, labels, statistics, centres, 4, CV_32S);
  for (int k = 1; k < specks; ++k)
    if (statistics(k, cv::CC_STAT_AREA) * cell_m2 < kSpeck_m2) {
      const cv::Rect box(statistics(k, cv::CC_STAT_LEFT), statistics(k, cv::CC_STAT_TOP), statistics(k, cv::CC_STAT_WIDTH),
                         statistics(k, cv::CC_STAT_HEIGHT));
      floor.open(box).setTo(0, labels(box) == k);
    }
  cv::distanceTransform(floor.open, floor.clearance, cv::DIST_L2, 5);
  return floor;
}

}  // namespace modslam
