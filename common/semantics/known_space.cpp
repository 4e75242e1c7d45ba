// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/known_space.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "common/semantics/chamfer.hpp"

namespace modslam {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

/// Contours run through cell centres; a region reaches half a cell farther: contours are taken on a grid twice as fine.
Ring to_ring(const std::vector<cv::Point>& contour, const KnownSpace& space, double tolerance_m) {
  std::vector<cv::Point> simple;
  cv::approxPolyDP(contour, simple, 2 * tolerance_m / space.resolution_m, true);
  Ring ring;
  for (const cv::Point& c : simple)
    ring.push_back(space.place(0.5 * (c.x + 0.5), 0.5 * (c.y + 0.5)));
  return ring;
}

/// Splices `hole` into `outline` where the two come nearest.
void splice(Ring& outline, const Ring& hole) {
  std::size_t at = 0, from = 0;
  double best = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < outline.size(); ++i)
    for (std::size_t j = 0; j < hole.size(); ++j)
      if (const double d = (outline[i] - hole[j]).squaredNorm(); d < best) best = d, at = i, from = j;
  Ring cut;
  for (std::size_t j = 0; j <= hole.size(); ++j) cut.push_back(hole[(from + j) % hole.size()]);
  cut.push_back(outline[at]);
  outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(at) + 1, cut.begin(), cut.end());
}

}  // namespace

Boxes KnownSpace::update(const OccupancyMap& map, const std::set<OccupancyMap::TileIndex>& tiles) {
  constexpr int kTile = OccupancyMap::kTileCells;
  const cv::Rect before = this->frame();
  cv::Rect frame = before;
  for (const auto& [x, y] : tiles) {
    const cv::Rect room = grown({x * kTile, y * kTile, kTile, kTile}, kFrameMargin);
    if ((room & frame) == room) continue;
    const cv::Rect all = frame.area() > 0 ? frame | room : room;
    const auto down = [](int v) { return static_cast<int>(std::floor(static_cast<double>(v) / kFrameCells)) * kFrameCells; };
    frame = cv::Rect(cv::Point(down(all.x), down(all.y)), cv::Point(-down(-all.br().x), -down(-all.br().y)));
  }
  const bool outgrown = frame != before;
  if (outgrown) {
    occupancy = empty() ? cv::Mat1b(frame.size(), std::uint8_t{0}) : grown(occupancy, {before.tl() - frame.tl(), frame.size()}, 0);
    corner = frame.tl();
  }
  Boxes changed;
  cv::Mat1b picture(kTile, kTile);
  for (const auto& index : tiles) {
    map.classes(index, picture[0]);
    take_over(occupancy, cv::Rect(index.first * kTile, index.second * kTile, kTile, kTile) - frame.tl(), picture, changed);
  }
  return before.area() == 0 && outgrown ? Boxes{cv::Rect({0, 0}, frame.size())} : changed;
}

KnownSpace::KnownSpace(const MapImage& map, double resolution) : resolution_m(resolution) {
  const cv::Mat1b cells(map.height, map.width, const_cast<std::uint8_t*>(map.cells.data()));
  std::vector<cv::Point> known;
  cv::findNonZero(cells, known);
  if (known.empty()) return;
  constexpr int kMargin = 4;
  const cv::Rect box = cv::boundingRect(known);
  const double scale = map.resolution_m / resolution;
  origin_m = map.origin_m + map.resolution_m * Eigen::Vector2d(box.x, box.y) - kMargin * resolution * Eigen::Vector2d(1, 1);
  const cv::Size size(static_cast<int>(std::ceil(box.width * scale)) + 2 * kMargin, static_cast<int>(std::ceil(box.height * scale)) + 2 * kMargin);
  cv::Mat1i free(size, 0), asked(size, 0);
  occupancy = cv::Mat1b(size, std::uint8_t{0});
  // A coarser map fills several cells with each of its own.
  const int steps = std::max(1, static_cast<int>(std::ceil(scale)));
  for (int y = 0; y < box.height * steps; ++y)
    for (int x = 0; x < box.width * steps; ++x) {
      const std::uint8_t value = cells(box.y + y / steps, box.x + x / steps);
      const int row = static_cast<int>((y + 0.5) * scale / steps) + kMargin, column = static_cast<int>((x + 0.5) * scale / steps) + kMargin;
      ++asked(row, column);
      free(row, column) += value > 0 && value < 128;
      if (value >= 128) occupancy(row, column) = 255;
    }
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
      if (occupancy(row, column) == 0 && 2 * free(row, column) > asked(row, column)) occupancy(row, column) = 1;
}

std::vector<Eigen::Vector2d> outline_of(const cv::Mat1b& mask, const KnownSpace& space, double min_hole_m2,
                                        double tolerance_m) {
  cv::Mat1b fine;
  cv::resize(mask, fine, cv::Size(), 2, 2, cv::INTER_NEAREST);
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> tree;
  cv::findContours(fine, contours, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  int outer = -1;
  for (int k = 0; k < static_cast<int>(contours.size()); ++k)
    if (tree[static_cast<std::size_t>(k)][3] < 0 &&
        (outer < 0 || contours[static_cast<std::size_t>(k)].size() > contours[static_cast<std::size_t>(outer)].size()))
      outer = k;
  if (outer < 0) return {};
  Ring ring = to_ring(contours[static_cast<std::size_t>(outer)], space, tolerance_m);
  const double cell_m2 = space.resolution_m * space.resolution_m / 4;
  for (int k = tree[static_cast<std::size_t>(outer)][2]; k >= 0; k = tree[static_cast<std::size_t>(k)][0]) {
    const auto& hole = contours[static_cast<std::size_t>(k)];
    if (cv::contourArea(hole) * cell_m2 < min_hole_m2) continue;
    const Ring inner = to_ring(hole, space, tolerance_m);
    if (inner.size() >= 3) splice(ring, inner);
  }
  if (ring.size() < 3) return {};
  double twice_area = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Eigen::Vector2d &p = ring[k], &q = ring[(k + 1) % ring.size()];
    twice_area += p.x() * q.y() - p.y() * q.x();
  }
  if (twice_area < 0) std::reverse(ring.begin(), ring.end());
  return ring;
}

std::vector<cv::Point> rim_cells(const cv::Mat1b& mask) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  std::vector<cv::Point> cells;
  for (const auto& contour : contours) cells.insert(cells.end(), contour.begin(), contour.end());
  return cells;
}

double thickness_m(const cv::Mat1b& mask, double resolution_m) {
  const cv::Rect box = box_of_set(mask);  // what lies around it says nothing
  return box.area() > 0 ? (2 * deepest(mask(box)) - 1) * resolution_m : -resolution_m;
}

double polygon_area_m2(const std::vector<Eigen::Vector2d>& outline) {
  double twice = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d &p = outline[k], &q = outline[(k + 1) % outline.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return 0.5 * std::abs(twice);
}

}  // namespace modslam
