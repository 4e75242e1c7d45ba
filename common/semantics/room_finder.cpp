// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/room_finder.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <unordered_map>

namespace modslam {
namespace {

constexpr int kMargin = 8;               // [cells] round a region
constexpr double kReach_m = 0.15;        // the outline lies on what was hit this near
constexpr double kDoorway_m = 0.3;       // a doorway reaches this far off its cut, ...
constexpr double kDeepestDoorway_m = 0.9;  // ... or this far where the wall is thick

/// How far a doorway reaches off its cut, towards n: as far as there is floor before the cut and none beside it, as between thick walls.
template <class IsFloor>
double doorway_m(const Gap& cut, const Eigen::Vector2d& n, IsFloor is_floor) {
  constexpr double kJamb_m = 0.15, kStep_m = 0.05;
  const Eigen::Vector2d jamb = kJamb_m * (cut.b - cut.a).normalized();
  double depth_m = kDoorway_m;
  for (double s = kDoorway_m; s < kDeepestDoorway_m && is_floor(cut.centre() + s * n) && !is_floor(cut.a - jamb + s * n) && !is_floor(cut.b + jamb + s * n); s += kStep_m)
    depth_m = s + 2 * kStep_m;
  return depth_m;
}

}  // namespace

RoomPatch RoomMap::patch_of(int region, const Partition& partition, const Floor& floor, const KnownSpace& space, bool glimpse) const {
  const double cell_m = space.resolution_m;
  const FloorRegion& found = partition.regions.at(region);
  const cv::Rect box = grown(found.box, kMargin) & cv::Rect({0, 0}, space.occupancy.size());
  const int reach = static_cast<int>(std::lround(kReach_m / cell_m));
  const cv::Rect wide = grown(box, reach) & cv::Rect({0, 0}, space.occupancy.size());
  cv::Mat1b barrier = floor.solid(wide).clone(), doorways(box.size(), std::uint8_t{0});
  const auto is_floor = [&](const Eigen::Vector2d& p) {
    const cv::Point c = space.cell(p);
    return box.contains(c) && partition.labels(c) == region;
  };
  const Eigen::Vector2d low = space.centre(wide.tl()).array() - 2 * kDoorway_m, high = space.centre(wide.br()).array() + 2 * kDoorway_m;
  for (const CutOpening& cut : partition.cuts) {
    if ((cut.opening.a.cwiseMax(cut.opening.b).array() < low.array()).any() || (cut.opening.a.cwiseMin(cut.opening.b).array() > high.array()).any()) continue;
    const cv::Point a = space.cell(cut.opening.a), b = space.cell(cut.opening.b);
    if (!meet(grown(cv::Rect(a, cv::Size(1, 1)) | cv::Rect(b, cv::Size(1, 1)), static_cast<int>(kDoorway_m / cell_m) + 2), wide)) continue;
    cv::line(barrier, a - wide.tl(), b - wide.tl(), cv::Scalar(255), 1, cv::LINE_8);
    const Eigen::Vector2d d = (cut.opening.b - cut.opening.a).normalized(), n(-d.y(), d.x());
    const Eigen::Vector2d up = doorway_m(cut.opening, n, is_floor) * n, down = -doorway_m(cut.opening, -n, is_floor) * n;
    std::vector<cv::Point> ring;
    for (const Eigen::Vector2d& p : std::array<Eigen::Vector2d, 4>{cut.opening.a + down, cut.opening.b + down, cut.opening.b + up, cut.opening.a + up}) ring.push_back(space.cell(p) - box.tl());
    cv::fillConvexPoly(doorways, ring, cv::Scalar(255));
  }
  cv::dilate(barrier, barrier, cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
  RoomPatch patch{{}, {}, barrier(box - wide.tl()), doorways, {}, cv::Mat1b(box.size(), std::uint8_t{0}), space, found.parking, glimpse};
  patch.space.occupancy = space.occupancy(box);
  cv::inRange(patch.space.occupancy, 1, 255, patch.seen);
  patch.space.corner += box.tl();
  cv::inRange(partition.labels(box), region, region, patch.mask);
  cv::inRange(partition.labels(box), 1, std::numeric_limits<int>::max(), patch.foreign);
  patch.foreign.setTo(0, patch.mask);
  return patch;
}

RoomMap::Look& RoomMap::look_at(int number, const Partition& partition, const Floor& floor, const KnownSpace& space, bool glimpse, const Boxes& changed, const cv::Rect& all) {
  const FloorRegion& region = partition.regions.at(number);
  const cv::Rect from = grown(region.box, kMargin + static_cast<int>(2 * kDoorway_m / space.resolution_m));
  const Place place{region.box.x, region.box.y, region.box.width, region.box.height};
  const auto [first, last] = looks_.equal_range(place);
  const bool untouched = !(meet(all, from) && meet(changed, from));
  const auto alike = [&](const Look& look) { return look.glimpse == glimpse && look.parking == region.parking; };
  for (auto known = first; untouched && known != last; ++known)
    if (known->second.region == number && alike(known->second)) return known->second;
  RoomPatch patch = patch_of(number, partition, floor, space, glimpse);
  cv::Mat1b picture = picture_of(patch);
  for (auto known = first; known != last; ++known)
    if (!known->second.asked && alike(known->second) && says_the_same(known->second.picture, picture)) {
      known->second.region = number;
      if (known->second.room) known->second.room->region = number;
      return known->second;
    }
  Room made;
  made.region = number;
  const bool is_room = make_room(patch, options_, made);
  cv::bitwise_or(picture, patch.matters, picture);
  return looks_.emplace(place, Look{number, glimpse, region.parking, picture, is_room ? std::optional<Room>(made) : std::nullopt})->second;
}

std::vector<Room> RoomMap::update(const Partition& partition, const Floor& floor, const KnownSpace& space, const Boxes& changed) {
  const double cell_m = space.resolution_m;
  const std::set<int> small = glimpses(partition, cell_m, options_.glimpse_m2);
  const cv::Rect all = bounds(changed);
  for (auto& [place, look] : looks_) look.asked = false;
  std::vector<Room> rooms;
  for (const auto& [number, region] : partition.regions) {
    if (region.box.area() * cell_m * cell_m < options_.min_area_m2) continue;
    Look& look = look_at(number, partition, floor, space, small.count(number) > 0, changed, all);
    look.asked = true;
    if (look.room) rooms.push_back(*look.room);
  }
  for (auto look = looks_.begin(); look != looks_.end();) look = look->second.asked ? std::next(look) : looks_.erase(look);
  const auto order = [](const Room& room) { return std::pair(room.outline[0].y(), room.outline[0].x()); };
  std::sort(rooms.begin(), rooms.end(), [&](const Room& p, const Room& q) { return order(p) < order(q); });
  return rooms;
}

void RoomMap::grow(const Growth& growth) {
  std::multimap<Place, Look> looks;
  for (auto& [place, look] : looks_) looks.emplace(Place{place[0] + growth.shift.x, place[1] + growth.shift.y, place[2], place[3]}, std::move(look));
  looks_ = std::move(looks);
}

std::vector<Room> find_rooms(const Partition& partition, const Floor& floor, const KnownSpace& space, const RoomOptions& options) {
  return RoomMap(options).update(partition, floor, space, {});
}

void join_rooms(std::vector<Door>& doors, const std::vector<Room>& rooms) {
  std::unordered_map<int, std::int64_t> id_of_region;
  for (const Room& room : rooms) id_of_region[room.region] = room.id;
  const auto id = [&](int region) {
    const auto found = id_of_region.find(region);
    return found == id_of_region.end() ? std::int64_t{0} : found->second;
  };
  for (Door& door : doors) {
    door.room_a = id(door.region_a);
    door.room_b = id(door.region_b);
  }
}

bool contains(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t k = 0, j = outline.size() - 1; k < outline.size(); j = k++) {
    const Eigen::Vector2d &a = outline[k], &b = outline[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) inside = !inside;
  }
  return inside;
}

}  // namespace modslam
