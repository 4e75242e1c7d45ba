// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/object_finder.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "common/semantics/object_class.hpp"

namespace modslam {
namespace {

constexpr double kMinArea_m2 = 0.03;
constexpr double kFillsBox = 0.75;        // what stands against a piece of wall fills its box, as discs do
constexpr double kWallThickness_m = 0.5, kWallExtent_m = 1.2;  // thin and long: a piece of wall between two doors

/// What of an island may be an object: all of it, or, where it has thin and long arms, what is thick. Such arms are wall, with furniture against it.
std::vector<Island> bodies_of(const Island& island, double cell_m) {
  if (std::max(island.box.width, island.box.height) * cell_m <= kWallExtent_m) return {island};
  const int disc = 2 * static_cast<int>(std::lround(kWallThickness_m / cell_m / 2)) + 1;
  cv::Mat1b all, thick, arms;
  cv::copyMakeBorder(island.mask, all, disc, disc, disc, disc, cv::BORDER_CONSTANT, 0);
  cv::morphologyEx(all, thick, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {disc, disc}));
  arms = all.clone();
  arms.setTo(0, thick);
  cv::Mat1i labels, stats;
  cv::Mat centres;
  const auto extent_m = [&](int k) { return std::max(stats(k, cv::CC_STAT_WIDTH), stats(k, cv::CC_STAT_HEIGHT)) * cell_m; };
  bool has_wall = false;
  for (int k = cv::connectedComponentsWithStats(arms, labels, stats, centres, 8, CV_32S) - 1; k > 0; --k) has_wall = has_wall || extent_m(k) > kWallExtent_m;
  if (!has_wall) return {island};
  std::vector<Island> out;
  const int count = cv::connectedComponentsWithStats(thick, labels, stats, centres, 8, CV_32S);
  for (int k = 1; k < count; ++k) {
    const cv::Rect box(stats(k, cv::CC_STAT_LEFT), stats(k, cv::CC_STAT_TOP), stats(k, cv::CC_STAT_WIDTH), stats(k, cv::CC_STAT_HEIGHT));
    Island body{box + island.box.tl() - cv::Point(disc, disc), {}, stats(k, cv::CC_STAT_AREA)};
    cv::inRange(labels(box), k, k, body.mask);
    const cv::Size2f sides = cv::minAreaRect(rim_cells(body.mask)).size;
    if (body.cells < kFillsBox * (sides.width + 1) * (sides.height + 1)) return {};  // a block of building
    out.push_back(body);
  }
  return out;
}

/// An island as an object; none when it is a speck, a piece of wall, or a shadow that no beam touched.
bool make_object(const Island& island, const KnownSpace& space, const Floor& floor, Object& object) {
  const double cell_m = space.resolution_m, area_m2 = island.cells * cell_m * cell_m;
  if (area_m2 < kMinArea_m2) return false;
  if (std::max(island.box.width, island.box.height) * cell_m > kWallExtent_m && thickness_m(island.mask, cell_m) < kWallThickness_m) return false;
  cv::Mat1b hit;
  cv::bitwise_and(floor.solid(island.box), island.mask, hit);
  const int hits = cv::countNonZero(hit);
  if (hits == 0) return false;
  KnownSpace part = space;
  part.corner += island.box.tl();
  object.outline = outline_of(island.mask, part, 1e9, 0.1);
  object.area_m2 = area_m2;
  const cv::Size2f sides = cv::minAreaRect(rim_cells(island.mask)).size;
  const ObjectClass guess = classify_footprint((sides.width + 1) * cell_m, (sides.height + 1) * cell_m);  // the rectangle runs through cells' centres
  object.class_name = guess.name;
  object.class_confidence = guess.confidence;
  object.evidence = static_cast<double>(hits) / island.cells;
  return object.outline.size() >= 3;
}

}  // namespace

void ObjectMap::grow(const Growth& growth) {
  mask = grown(mask, growth, 0);
  for (Footprint& footprint : objects)
    for (cv::Rect* box : {&footprint.island.box, &footprint.whole.box}) *box += growth.shift;
}

Boxes update_objects(ObjectMap& map, const KnownSpace& space, const Floor& floor, const Boxes& changed, const std::vector<Island>& islands) {
  const cv::Size frame = space.occupancy.size();
  if (map.mask.size() != frame) map = {{}, cv::Mat1b(frame, std::uint8_t{0})};
  const Boxes touched = windows(changed, 1, frame);
  const cv::Rect all = bounds(touched);
  Boxes stirred;
  const auto is_touched = [&](const ObjectMap::Footprint& footprint) {
    const Island &island = footprint.island, &whole = footprint.whole;
    const bool touches = meet(all, whole.box) && std::any_of(touched.begin(), touched.end(), [&](const cv::Rect& box) {
      const cv::Rect common = (box & whole.box) - whole.box.tl();
      return common.area() > 0 && cv::countNonZero(whole.mask(common)) > 0;
    });
    if (touches) map.mask(island.box).setTo(0, island.mask), stirred.push_back(island.box);
    return touches;
  };
  map.objects.erase(std::remove_if(map.objects.begin(), map.objects.end(), is_touched), map.objects.end());
  for (const Island& whole : islands) {
    cv::Mat1b known;
    cv::bitwise_and(map.mask(whole.box), whole.mask, known);
    if (cv::countNonZero(known) > 0) continue;
    for (const Island& island : bodies_of(whole, space.resolution_m)) {
      ObjectMap::Footprint found{island, whole, {}};
      if (!make_object(island, space, floor, found.object)) continue;
      map.mask(island.box).setTo(255, island.mask);
      stirred.push_back(island.box);
      map.objects.push_back(found);
    }
  }
  if (stirred.empty()) return stirred;
  std::sort(map.objects.begin(), map.objects.end(), [](const auto& p, const auto& q) {
    const auto order = [](const Island& island) { return std::tuple(island.box.y, island.box.x, island.cells); };
    return order(p.island) < order(q.island);
  });
  return stirred;
}

}  // namespace modslam
