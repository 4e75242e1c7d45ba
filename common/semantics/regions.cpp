// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/regions.hpp"

#include <algorithm>
#include <deque>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

constexpr double kLeak_m = 0.2;  // half of the widest leak that is held
constexpr int kSeen = 2;         // crossings

cv::Point pixel_of(const Raster& raster, const Eigen::Vector2d& p) {
  const Eigen::Vector2d q = raster.to_pixel(p);
  return {cvRound(q.x()), cvRound(q.y())};
}

/// Floods the markers over the passable pixels, one ring at a time.
void grow(cv::Mat& labels, const cv::Mat& passable) {
  std::deque<cv::Point> edge;
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (labels.at<int>(y, x) > 0) edge.emplace_back(x, y);
  const cv::Point steps[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  while (!edge.empty()) {
    const cv::Point p = edge.front();
    edge.pop_front();
    for (const cv::Point& step : steps) {
      const cv::Point q = p + step;
      if (q.x < 0 || q.y < 0 || q.x >= labels.cols || q.y >= labels.rows) continue;
      if (!passable.at<std::uint8_t>(q) || labels.at<int>(q) != 0) continue;
      labels.at<int>(q) = labels.at<int>(p);
      edge.push_back(q);
    }
  }
}

}  // namespace

int Raster::label_at(const Eigen::Vector2d& p) const {
  const cv::Point q = pixel_of(*this, p);
  return q.x < 0 || q.y < 0 || q.x >= labels.cols || q.y >= labels.rows ? 0 : labels.at<int>(q);
}

Raster seen_floor(const Evidence& evidence) {
  int low_x = 1 << 30, low_y = 1 << 30, high_x = -(1 << 30), high_y = -(1 << 30);
  evidence.free().each([&](int ix, int iy, std::int32_t count) {
    if (count < kSeen) return;
    low_x = std::min(low_x, ix), high_x = std::max(high_x, ix);
    low_y = std::min(low_y, iy), high_y = std::max(high_y, iy);
  });
  Raster raster;
  raster.resolution_m = evidence.free().resolution_m();
  if (low_x > high_x) return raster;
  raster.ix0 = low_x - 3;
  raster.iy0 = low_y - 3;
  raster.seen = cv::Mat::zeros(high_y - low_y + 7, high_x - low_x + 7, CV_8U);
  raster.labels = cv::Mat::zeros(raster.seen.size(), CV_32S);
  evidence.free().each([&](int ix, int iy, std::int32_t count) {
    if (count >= kSeen) raster.seen.at<std::uint8_t>(iy - raster.iy0, ix - raster.ix0) = 255;
  });
  evidence.hits().each([&](int ix, int iy, const HitCell& cell) {  // furniture stands on floor
    if (cell.hits() == 0) return;
    const int x = (ix >> 1) - raster.ix0, y = (iy >> 1) - raster.iy0;
    if (x >= 0 && y >= 0 && x < raster.seen.cols && y < raster.seen.rows)
      raster.seen.at<std::uint8_t>(y, x) = 255;
  });
  return raster;
}

void label_regions(Raster& raster, const std::vector<Segment>& barriers, double min_area_m2) {
  static_assert(Evidence::kFreeFactor == 2, "seen_floor halves the cell index");
  cv::Mat passable = raster.seen.clone();
  for (const Segment& s : barriers)
    cv::line(passable, pixel_of(raster, s.a), pixel_of(raster, s.b), 0, 1, 4);
  cv::Mat depth;
  cv::distanceTransform(passable, depth, cv::DIST_L2, 5);
  const cv::Mat cores = depth > kLeak_m / raster.resolution_m;
  cv::Mat components, stats, centroids;
  const int n = cv::connectedComponentsWithStats(cores, components, stats, centroids, 4);
  const double min_core_px = 0.3 * min_area_m2 / (raster.resolution_m * raster.resolution_m);
  std::vector<int> name(static_cast<std::size_t>(n), 0);
  raster.regions = 0;
  for (int c = 1; c < n; ++c)
    if (stats.at<int>(c, cv::CC_STAT_AREA) >= min_core_px)
      name[static_cast<std::size_t>(c)] = ++raster.regions;
  for (int y = 0; y < components.rows; ++y)
    for (int x = 0; x < components.cols; ++x)
      raster.labels.at<int>(y, x) = name[static_cast<std::size_t>(components.at<int>(y, x))];
  grow(raster.labels, passable);
}

}  // namespace modslam
