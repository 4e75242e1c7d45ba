// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/object_finder.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "common/semantics/object_class.hpp"

namespace modslam {
namespace {

constexpr double kMinArea_m2 = 0.03;
constexpr double kWallThickness_m = 0.5, kWallExtent_m = 1.2;  // thin and long: a piece of wall between two doors

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
  part.origin_m += cell_m * Eigen::Vector2d(island.box.x, island.box.y);
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

Boxes update_objects(ObjectMap& map, const KnownSpace& space, const Floor& floor, const Boxes& changed, const std::vector<Island>& islands) {
  const cv::Size frame = space.occupancy.size();
  if (map.mask.size() != frame) map = {{}, cv::Mat1b(frame, std::uint8_t{0})};
  const Boxes touched = windows(changed, 1, frame);
  Boxes stirred;
  const auto is_touched = [&](const ObjectMap::Footprint& footprint) {
    const Island& island = footprint.island;
    const bool touches = std::any_of(touched.begin(), touched.end(), [&](const cv::Rect& box) {
      const cv::Rect common = (box & island.box) - island.box.tl();
      return common.area() > 0 && cv::countNonZero(island.mask(common)) > 0;
    });
    if (touches) map.mask(island.box).setTo(0, island.mask), stirred.push_back(island.box);
    return touches;
  };
  map.objects.erase(std::remove_if(map.objects.begin(), map.objects.end(), is_touched), map.objects.end());
  for (const Island& island : islands) {
    ObjectMap::Footprint found{island, {}};
    cv::Mat1b known;
    cv::bitwise_and(map.mask(island.box), island.mask, known);
    if (cv::countNonZero(known) > 0 || !make_object(island, space, floor, found.object)) continue;
    map.mask(island.box).setTo(255, island.mask);
    stirred.push_back(island.box);
    map.objects.push_back(found);
  }
  std::sort(map.objects.begin(), map.objects.end(), [](const auto& p, const auto& q) {
    return std::pair(p.island.box.y, p.island.box.x) < std::pair(q.island.box.y, q.island.box.x);
  });
  return stirred;
}

}  // namespace modslam
