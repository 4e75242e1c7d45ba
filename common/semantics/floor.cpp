// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/floor.hpp"

#include <algorithm>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "common/semantics/chamfer.hpp"

namespace modslam {
namespace {

constexpr double kSmall_m = 1.0;          // islands no longer than this are things, whatever their shape
constexpr double kWallThickness_m = 0.5;  // longer ones are pieces of wall when they are thinner than this ...
constexpr double kCompact = 0.85;          // ... or fill less of their box: a cupboard stands against the piece
constexpr double kRay_m = 0.2;              // floor is at least this wide
constexpr double kFan_m = 0.5, kNearSolid_m = 0.25;  // ... and at least this where nothing was hit near by: beams through a door spread like a fan
constexpr double kSpeck_m2 = 1.0;  // smaller patches of floor on their own say nothing

constexpr double kLongestThing_m = 6.4, kLongestSpeck_m = 4.8;

double share_of_box(const cv::Mat1b& mask) {
  const cv::Size2f size = cv::minAreaRect(rim_cells(mask)).size;
  return cv::countNonZero(mask) / static_cast<double>((size.width + 1) * (size.height + 1));
}

cv::Mat structure(int shape, double width_m, double resolution_m) {
  const int cells = 2 * static_cast<int>(std::lround(width_m / resolution_m / 2)) + 1;
  return cv::getStructuringElement(shape, {cells, cells});
}

/// Islands of the mask that meet the change.
std::vector<Island> islands_of(const cv::Mat1b& mask, const Boxes& changed, const IslandLimits& limits) {
  std::vector<Island> out;
  each_island(mask, changed, limits, [&](const Island& island) { out.push_back(island); });
  return out;
}

/// What was marked and met the change is marked no more, unless it is found again. @return boxes of what is new or gone.
Boxes update_marks(cv::Mat1b& marks, const Boxes& changed, const IslandLimits& limits, const std::vector<Island>& now) {
  const std::vector<Island> before = islands_of(marks, changed, limits);
  for (const Island& island : before) marks(island.box).setTo(0, island.mask);
  for (const Island& island : now) marks(island.box).setTo(255, island.mask);
  Boxes news;
  const auto same = [](const Island& p, const Island& q) { return p.box == q.box && difference(p.mask, q.mask).area() == 0; };
  const auto note = [&](const std::vector<Island>& these, const std::vector<Island>& those) {
    for (const Island& one : these)
      if (std::none_of(those.begin(), those.end(), [&](const Island& other) { return same(one, other); })) news.push_back(one.box);
  };
  note(before, now);
  note(now, before);
  return news;
}

/// The floor without what beams through gaps leave of it; of the window's cells those that are 15 or more off its rim are right.
cv::Mat1b sweep(const cv::Mat1b& open, const cv::Mat1b& solid, double resolution_m) {
  cv::Mat1b swept, broad;
  // Single beams through a gap leave rays; what is thinner than a hand's breadth is none of the floor.
  cv::morphologyEx(open, swept, cv::MORPH_OPEN, structure(cv::MORPH_ELLIPSE, kRay_m, resolution_m));
  cv::dilate(solid, broad, structure(cv::MORPH_RECT, 2 * kNearSolid_m, resolution_m));
  cv::bitwise_or(broad, swept, broad);
  cv::morphologyEx(broad, broad, cv::MORPH_OPEN, structure(cv::MORPH_RECT, kFan_m, resolution_m));
  cv::bitwise_and(swept, broad, swept);
  return swept;
}

}  // namespace

void Floor::allocate(const cv::Size& frame) {
  for (cv::Mat1b* raster : {&open, &solid, &closed, &things, &swept, &specks}) *raster = cv::Mat1b(frame, std::uint8_t{0});
  closed.setTo(255);
  clearance = cv::Mat1f(frame, 0.0F);
}

void Floor::grow(const Growth& growth) {
  for (cv::Mat1b* raster : {&open, &solid, &things, &swept, &specks}) *raster = grown(*raster, growth, 0);
  closed = grown(closed, growth, 255);
  clearance = grown(clearance, growth, 0.0F);
}

Floor make_floor(const KnownSpace& space, double island_max_m2) {
  Floor floor;
  update_floor(floor, space, island_max_m2, {cv::Rect({0, 0}, space.occupancy.size())});
  return floor;
}

FloorChange update_floor(Floor& floor, const KnownSpace& space, double island_max_m2, const Boxes& changed) {
  FloorChange change;
  floor.resolution_m = space.resolution_m;
  if (space.empty()) return change;
  const cv::Size frame = space.occupancy.size();
  if (floor.open.size() != frame) floor.allocate(frame);
  const double cell_m = space.resolution_m, cell_m2 = cell_m * cell_m;
  const auto cells = [&](double metres) { return static_cast<int>(std::ceil(metres / cell_m)); };
  cv::Mat1b picture;
  Boxes stirred;
  for (const cv::Rect& box : changed) {
    cv::inRange(space.occupancy(box), 128, 255, picture);
    take_over(floor.solid, box, picture, change.solid);
    cv::inRange(space.occupancy(box), 1, 127, picture);
    cv::bitwise_not(picture, picture);
    take_over(floor.closed, box, picture, stirred);
  }
  const auto limits = [&](double longest_m, double most_m2, int connectivity) {
    return IslandLimits{cells(longest_m), static_cast<int>(most_m2 / cell_m2), connectivity};
  };
  const auto is_thing = [&](const Island& island) {
    if (std::max(island.box.width, island.box.height) * cell_m <= kSmall_m) return true;
    return thickness_m(island.mask, cell_m) >= kWallThickness_m && share_of_box(island.mask) >= kCompact;
  };
  const IslandLimits blocks = limits(kLongestThing_m, island_max_m2, 8);
  change.islands = islands_of(floor.closed, changed, blocks);
  std::vector<Island> small;
  std::copy_if(change.islands.begin(), change.islands.end(), std::back_inserter(small), is_thing);
  const Boxes things = update_marks(floor.things, changed, blocks, small);
  stirred.insert(stirred.end(), things.begin(), things.end());
  stirred.insert(stirred.end(), change.solid.begin(), change.solid.end());

  const int reach = cells(kRay_m + 2 * kNearSolid_m + kFan_m);
  Boxes swept;
  for (const cv::Rect& box : windows(stirred, reach, frame)) {
    const cv::Rect window = grown(box, reach) & cv::Rect({0, 0}, frame);
    cv::Mat1b open;
    cv::bitwise_not(floor.closed(window), open);
    cv::bitwise_or(open, floor.things(window), open);
    take_over(floor.swept, box, sweep(open, floor.solid(window), cell_m)(box - window.tl()), swept);
  }
  // Beams that slipped through a window leave single cells and threads beyond it.
  const IslandLimits loose = limits(kLongestSpeck_m, kSpeck_m2, 4);
  const Boxes specks = update_marks(floor.specks, swept, loose, islands_of(floor.swept, swept, loose));
  swept.insert(swept.end(), specks.begin(), specks.end());
  for (const cv::Rect& box : swept) {
    cv::bitwise_not(floor.specks(box), picture);
    cv::bitwise_and(floor.swept(box), picture, picture);
    take_over(floor.open, box, picture, change.open);
  }
  const int farthest = cells(Floor::kFarthest_m);
  for (const cv::Rect& box : windows(change.open, farthest, frame)) {
    const cv::Rect window = grown(box, farthest) & cv::Rect({0, 0}, frame);
    take_over(floor.clearance, box, distances(floor.open(window), static_cast<float>(farthest))(box - window.tl()), change.clearance);
  }
  return change;
}

}  // namespace modslam
