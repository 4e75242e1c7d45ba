// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/room_finder.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

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

/// What came as it went is no news.
void drop_both(std::vector<Corners>& gone, std::vector<Corners>& come) {
  const auto went = [&](const Corners& outline) {
    const auto same = std::find(gone.begin(), gone.end(), outline);
    if (same == gone.end()) return false;
    gone.erase(same);
    return true;
  };
  come.erase(std::remove_if(come.begin(), come.end(), went), come.end());
}

}  // namespace

RoomPatch RoomMap::patch_of(const FloorRegion& region, const Partition& partition, const Floor& floor, const KnownSpace& space, bool glimpse) const {
  const double cell_m = space.resolution_m;
  const cv::Rect box = grown(region.box, kMargin) & cv::Rect({0, 0}, space.occupancy.size());
  const int reach = static_cast<int>(std::lround(kReach_m / cell_m));
  const cv::Rect wide = grown(box, reach) & cv::Rect({0, 0}, space.occupancy.size());
  cv::Mat1b barrier = floor.solid(wide).clone(), doorways(box.size(), std::uint8_t{0});
  const auto is_floor = [&](const Eigen::Vector2d& p) {
    const cv::Point c = space.cell(p);
    return box.contains(c) && partition.labels(c) == region.number;
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
  RoomPatch patch{{}, {}, barrier(box - wide.tl()), doorways, {}, cv::Mat1b(box.size(), std::uint8_t{0}), space, region.parking, glimpse};
  patch.space.occupancy = space.occupancy(box);
  cv::inRange(patch.space.occupancy, 1, 255, patch.seen);
  patch.space.corner += box.tl();
  cv::inRange(partition.labels(box), region.number, region.number, patch.mask);
  cv::inRange(partition.labels(box), 1, std::numeric_limits<int>::max(), patch.foreign);
  patch.foreign.setTo(0, patch.mask);
  return patch;
}

std::vector<const RoomMap::Look*>::iterator RoomMap::place_of(const Look& look) {
  const auto order = [](const Look& one) { return std::pair(one.room->outline[0].y(), one.room->outline[0].x()); };
  return std::lower_bound(listed_.begin(), listed_.end(), &look, [&](const Look* p, const Look* q) { return order(*p) < order(*q); });
}

/// @param spare  looks at regions that are gone or near changes: one that shows the same is taken.
std::unique_ptr<RoomMap::Look> RoomMap::look_at(const FloorRegion& region, const Partition& partition, const Floor& floor, const KnownSpace& space, bool glimpse,
                                                Looks& spare) {
  RoomPatch patch = patch_of(region, partition, floor, space, glimpse);
  cv::Mat1b picture = picture_of(patch);
  for (std::unique_ptr<Look>& known : spare)
    if (known && known->region.box == region.box && known->glimpse == glimpse && known->region.parking == region.parking && says_the_same(known->picture, picture)) {
      known->region = region;
      if (known->room) known->room->region = region.number;
      return std::move(known);
    }
  Room made;
  made.region = region.number;
  const bool is_room = make_room(patch, options_, made);
  cv::bitwise_or(picture, patch.matters, picture);
  auto look = std::make_unique<Look>(Look{region, glimpse, picture, is_room ? std::optional<Room>(made) : std::nullopt});
  if (is_room) {
    listed_.insert(place_of(*look), look.get());
    news_.come.push_back(made.outline);
  }
  return look;
}

std::vector<Room> RoomMap::update(const Partition& partition, const Floor& floor, const KnownSpace& space, const Boxes& changed) {
  const double cell_m = space.resolution_m;
  const cv::Rect all = bounds(changed);
  const auto is_touched = [&](const cv::Rect& region) {
    const cv::Rect from = grown(region, kMargin + static_cast<int>(2 * kDoorway_m / cell_m));
    return meet(all, from) && meet(changed, from);
  };
  news_ = {};
  Looks now, spare;
  std::vector<std::pair<std::size_t, const FloorRegion*>> stale;
  auto known = looks_.begin();
  for (const FloorRegion& region : partition.regions) {
    if (region.box.area() * cell_m * cell_m < options_.min_area_m2) continue;
    for (; known != looks_.end() && (*known)->region.number < region.number; ++known) spare.push_back(std::move(*known));
    const bool same = known != looks_.end() && (*known)->region.number == region.number;
    if (same && (*known)->glimpse == region.is_glimpse(cell_m, options_.glimpse_m2) && (*known)->region.parking == region.parking && !is_touched(region.box)) {
      now.push_back(std::move(*known++));
      continue;
    }
    if (same) spare.push_back(std::move(*known++));
    stale.emplace_back(now.size(), &region);
    now.emplace_back();
  }
  for (; known != looks_.end(); ++known) spare.push_back(std::move(*known));
  for (const auto& [place, region] : stale) now[place] = look_at(*region, partition, floor, space, region->is_glimpse(cell_m, options_.glimpse_m2), spare);
  for (const std::unique_ptr<Look>& gone : spare)
    if (gone && gone->room) {
      listed_.erase(std::find(place_of(*gone), listed_.end(), gone.get()));
      news_.gone.push_back(gone->room->outline);
    }
  looks_ = std::move(now);
  drop_both(news_.gone, news_.come);
  std::vector<Room> rooms;
  rooms.reserve(listed_.size());
  for (const Look* look : listed_) rooms.push_back(*look->room);
  return rooms;
}

bool RoomMap::is_room(int region) const {
  const auto look = std::lower_bound(looks_.begin(), looks_.end(), region, [](const std::unique_ptr<Look>& one, int number) { return one->region.number < number; });
  return look != looks_.end() && (*look)->region.number == region && (*look)->room;
}

void RoomMap::grow(const Growth& growth) {
  for (const std::unique_ptr<Look>& look : looks_) look->region.box += growth.shift;
}

std::vector<Room> find_rooms(const Partition& partition, const Floor& floor, const KnownSpace& space, const RoomOptions& options) {
  return RoomMap(options).update(partition, floor, space, {});
}

void join_rooms(std::vector<Door>& doors, const std::vector<Room>& rooms) {
  std::vector<std::pair<int, std::int64_t>> ids;  // by region
  for (const Room& room : rooms) ids.emplace_back(room.region, room.id);
  std::sort(ids.begin(), ids.end());
  const auto id = [&](int region) {
    const auto found = std::lower_bound(ids.begin(), ids.end(), std::pair(region, std::int64_t{0}));
    return found == ids.end() || found->first != region ? std::int64_t{0} : found->second;
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
