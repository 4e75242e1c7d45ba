// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/room_finder.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

constexpr double kTolerance_m = 0.15;    // of the outline's corners
constexpr double kMinHole_m2 = 3.0;      // smaller ones are furniture
constexpr double kCorridorWidth_m = 3.2, kCorridorElongation = 4.0;

void draw(cv::Mat1b& image, const KnownSpace& space, const Eigen::Vector2d& a, const Eigen::Vector2d& b, int value) {
  cv::line(image, space.cell(a), space.cell(b), cv::Scalar(value), 1, cv::LINE_8);  // 8-connected: stops a 4-connected flood
}

/// 255 where both are set.
cv::Mat1b both(const cv::Mat1b& p, const cv::Mat1b& q) {
  cv::Mat1b p_set, q_set, out;
  cv::inRange(p, 1, 255, p_set);
  cv::inRange(q, 1, 255, q_set);
  cv::bitwise_and(p_set, q_set, out);
  return out;
}

/// Spreads each label into what is neither barrier nor labelled, at most `steps` cells deep.
void grow(cv::Mat1i& labels, const cv::Mat1b& barrier, int steps) {
  std::vector<cv::Point> front, next;
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (labels(y, x) > 0) front.push_back({x, y});
  for (int step = 0; step < steps && !front.empty(); ++step) {
    next.clear();
    for (const cv::Point& c : front)
      for (const cv::Point& d : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
        const cv::Point to = c + d;
        if (to.x < 0 || to.y < 0 || to.x >= labels.cols || to.y >= labels.rows) continue;
        if (labels(to) != 0 || barrier(to)) continue;
        labels(to) = labels(c);
        next.push_back(to);
      }
    std::swap(front, next);
  }
}

/// Share of the region's rim that touches a barrier.
double enclosed_share(const cv::Mat1b& mask, const cv::Mat1b& barrier_near) {
  cv::Mat1b rim;
  cv::morphologyEx(mask, rim, cv::MORPH_GRADIENT, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  const int all = cv::countNonZero(rim);
  return all ? static_cast<double>(cv::countNonZero(both(rim, barrier_near))) / all : 0.0;
}

bool is_corridor(const cv::Mat1b& mask, double area_m2, double resolution_m) {
  cv::Mat1f depth;
  cv::Mat1b padded;
  cv::copyMakeBorder(mask, padded, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);
  cv::distanceTransform(padded, depth, cv::DIST_L2, 3);
  double deepest = 0;
  cv::minMaxLoc(depth, nullptr, &deepest);
  const double width_m = 2 * deepest * resolution_m;
  return width_m < kCorridorWidth_m && area_m2 / (width_m * width_m) > kCorridorElongation;
}

}  // namespace

std::vector<Room> find_rooms(const std::vector<Wall>& walls, const std::vector<Door>& doors, const KnownSpace& space,
                             const RoomOptions& options) {
  if (space.empty()) return {};
  cv::Mat1b barrier(space.occupancy.size(), std::uint8_t{0});
  for (const Wall& wall : walls) {
    const Eigen::Vector2d out = options.wall_extension_m * wall.direction();
    draw(barrier, space, wall.a - out, wall.b + out, 255);
  }
  for (const Door& door : doors) {
    const Eigen::Vector2d out = 0.25 * (door.b - door.a).normalized();
    draw(barrier, space, door.a - out, door.b + out, 255);
  }
  // Cells seen free more often than not, outside the barriers, are the floor.
  cv::Mat1b floor;
  cv::inRange(space.occupancy, 1, 127, floor);
  floor.setTo(0, barrier);
  cv::Mat1i labels, statistics;
  cv::Mat1d centres;
  const int count = cv::connectedComponentsWithStats(floor, labels, statistics, centres, 4, CV_32S);
  const double cell_m2 = space.resolution_m * space.resolution_m;
  std::vector<int> kept;
  for (int k = 1; k < count; ++k)
    if (statistics(k, cv::CC_STAT_AREA) * cell_m2 >= options.min_area_m2) kept.push_back(k);
  cv::Mat1i regions(labels.size(), 0);
  for (const int k : kept) regions.setTo(k, labels == k);
  grow(regions, barrier, static_cast<int>(options.fringe_m / space.resolution_m));

  cv::Mat1b barrier_near;
  cv::dilate(barrier, barrier_near, cv::getStructuringElement(cv::MORPH_RECT, {5, 5}));
  std::vector<Room> rooms;
  for (const int k : kept) {
    cv::Mat1b region;
    cv::inRange(regions, k, k, region);
    cv::Rect box = cv::boundingRect(region);
    box = cv::Rect(box.x - 2, box.y - 2, box.width + 4, box.height + 4) & cv::Rect(0, 0, region.cols, region.rows);
    cv::Mat1b mask = region(box).clone();
    KnownSpace part = space;  // shares the picture's data; only the origin differs
    part.origin_m += space.resolution_m * Eigen::Vector2d(box.x, box.y);

    Room room;
    room.outline = outline_of(mask, part, kMinHole_m2, kTolerance_m);
    if (room.outline.size() < 3) continue;
    std::vector<cv::Point> ring;
    for (const Eigen::Vector2d& p : room.outline) ring.push_back(part.cell(p));
    cv::Mat1b filled(mask.size(), std::uint8_t{0});
    cv::fillPoly(filled, std::vector<std::vector<cv::Point>>{ring}, cv::Scalar(255));
    room.area_m2 = polygon_area_m2(room.outline);
    const double inside = cv::countNonZero(filled);
    room.explored = inside > 0 ? cv::countNonZero(both(filled, space.occupancy(box))) / inside : 0.0;
    room.evidence = enclosed_share(mask, barrier_near(box));
    room.corridor = is_corridor(mask, room.area_m2, space.resolution_m);
    if (room.area_m2 < options.min_area_m2 || room.evidence < options.min_enclosed || room.explored < options.min_explored) continue;
    rooms.push_back(room);
  }
  return rooms;
}

void join_rooms(std::vector<Door>& doors, const std::vector<Room>& rooms) {
  const auto room_at = [&](const Eigen::Vector2d& p) -> std::int64_t {
    for (const Room& room : rooms)
      if (contains(room.outline, p)) return room.id;
    return 0;
  };
  for (Door& door : doors) {
    const Eigen::Vector2d u = (door.b - door.a).normalized(), n(-u.y(), u.x());
    door.room_a = door.room_b = 0;
    for (double d = 0.2; d < 0.8 && door.room_a == 0; d += 0.1) door.room_a = room_at(door.centre() + d * n);
    for (double d = 0.2; d < 0.8 && door.room_b == 0; d += 0.1) door.room_b = room_at(door.centre() - d * n);
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
