// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/hidden_space.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

constexpr double kAtOutline_m = 0.2;  // walls lie this near the outline of their room

/// Corners of the box around an outline [m].
std::pair<Eigen::Vector2d, Eigen::Vector2d> box_of(const Corners& outline) {
  Eigen::Vector2d low = outline[0], high = outline[0];
  for (const Eigen::Vector2d& p : outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return {low, high};
}

std::vector<cv::Point> cells_of(const Corners& outline, const KnownSpace& space, const cv::Point& corner) {
  std::vector<cv::Point> ring;
  for (const Eigen::Vector2d& p : outline) ring.push_back(space.cell(p) - corner);
  return ring;
}

}  // namespace

void HiddenSpace::take(const RoomMap::News& rooms) {
  outlines_.next_round();
  for (const Corners& outline : rooms.gone) {
    const auto [low, high] = box_of(outline);
    for (const std::size_t number : index_.near(low, high, 0))
      if (outlines_[number] == outline) {
        index_.remove(low, high, number);
        outlines_.give_back(number);
        break;
      }
  }
  for (const Corners& outline : rooms.come) {
    const auto [low, high] = box_of(outline);
    index_.add(low, high, outlines_.take(outline));
  }
}

Boxes HiddenSpace::update(const RoomMap::News& rooms, const KnownSpace& space, const Floor& floor, const Boxes& open) {
  Boxes changed;
  if (picture_.size() != space.occupancy.size()) {
    picture_ = cv::Mat1b(space.occupancy.size(), std::uint8_t{0});
    changed.emplace_back(cv::Point(0, 0), picture_.size());
  }
  take(rooms);
  const int thick = 2 * static_cast<int>(std::lround(kAtOutline_m / space.resolution_m)) + 1;
  Boxes stirred = open;
  for (const std::vector<Corners>* outlines : {&rooms.gone, &rooms.come})
    for (const Corners& outline : *outlines) stirred.push_back(grown(cv::boundingRect(cells_of(outline, space, {0, 0})), thick));
  for (const cv::Rect& box : windows(stirred, 0, picture_.size())) {
    cv::Mat1b part(box.size(), std::uint8_t{0});
    std::vector<std::vector<cv::Point>> near;
    for (const std::size_t number : index_.near(space.place(box.x, box.y), space.place(box.br().x, box.br().y), 2 * thick * space.resolution_m)) {
      near.push_back(cells_of(outlines_[number], space, box.tl()));
      cv::fillPoly(part, std::vector<std::vector<cv::Point>>{near.back()}, cv::Scalar(255));
    }
    cv::polylines(part, near, true, cv::Scalar(0), thick);
    part.setTo(0, floor.open(box));
    take_over(picture_, box, part, changed);
  }
  return changed;
}

}  // namespace modslam
