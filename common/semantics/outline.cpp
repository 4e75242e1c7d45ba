// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/outline.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/geometry/pose2.hpp"

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kOutline_m = 0.12;      // detail of the outline that makes no corner
constexpr double kReflex_rad = 0.5;      // least turn of a corner
constexpr double kHalo_m = 1.0;

double cross(const Vec& a, const Vec& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A chain of outline points that ends at the rim of what was looked at, or a whole ring.
struct Chain {
  std::vector<cv::Point> points;
  bool closed = false;
};

/// Contours of a crop are closed along its rim; what runs there is none of the floor's outline.
std::vector<Chain> chains_of(const std::vector<cv::Point>& contour, const cv::Size& crop) {
  const auto at_rim = [&](const cv::Point& p) { return p.x <= 0 || p.y <= 0 || p.x >= crop.width - 1 || p.y >= crop.height - 1; };
  const auto start = std::find_if(contour.begin(), contour.end(), at_rim);
  if (start == contour.end()) return {{contour, true}};
  std::vector<Chain> out;
  const std::size_t n = contour.size(), first = static_cast<std::size_t>(start - contour.begin());
  for (std::size_t k = 1; k <= n; ++k) {
    const cv::Point& p = contour[(first + k) % n];
    if (at_rim(p)) continue;
    if (at_rim(contour[(first + k - 1) % n])) out.emplace_back();
    out.back().points.push_back(p);
  }
  return out;
}

}  // namespace

Outline trace(const Floor& floor, const cv::Rect& block) {
  Outline out;
  const int halo = static_cast<int>(std::lround(kHalo_m / floor.resolution_m));
  const cv::Rect crop = grown(block, halo) & cv::Rect({0, 0}, floor.open.size());
  std::vector<std::vector<cv::Point>> contours;
  cv::Mat1b padded;
  cv::copyMakeBorder(floor.open(crop), padded, 1, 1, 1, 1, cv::BORDER_REPLICATE);
  cv::findContours(padded, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  for (const auto& contour : contours)
    for (const Chain& chain : chains_of(contour, padded.size())) {
      std::vector<cv::Point> ring;
      cv::approxPolyDP(chain.points, ring, kOutline_m / floor.resolution_m, chain.closed);
      const std::size_t n = ring.size();
      if (n < 2) continue;
      const auto at = [&](std::size_t k) { return Vec(ring[k % n].x + crop.x - 1, ring[k % n].y + crop.y - 1); };
      for (std::size_t k = 0; k < n; ++k) {
        const bool ends = !chain.closed && k + 1 == n;
        if (!ends) out.edges.push_back({at(k), at(k + 1)});
        if (!chain.closed && (k == 0 || ends)) continue;
        const Vec p = at(k), before = (at(k + n - 1) - p).normalized(), after = (at(k + 1) - p).normalized();
        // OpenCV keeps the floor on one side of all contours, outer ones and holes alike: there a corner turns the other way.
        const double turn = std::atan2(cross(-before, after), -before.dot(after));
        const bool here = block.contains(cv::Point(static_cast<int>(p.x()), static_cast<int>(p.y())));
        if (here && (turn > kReflex_rad || n == 2)) out.corners.push_back({p, before, after, n == 2 ? kPi : turn});
      }
    }
  return out;
}

}  // namespace modslam
