// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/room_patch.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

constexpr double kTolerance_m = 0.1;     // of the outline's corners
constexpr double kMinHole_m2 = 3.0;      // smaller ones are furniture
constexpr double kCorridorWidth_m = 3.2, kCorridorElongation = 4.0;
constexpr double kStrip_m = 0.25, kCounter_m = 1.3, kBulky_m = 3.0, kBulkyLength_m = 4.0;  // of what hides floor, with its shadow
constexpr double kNeck_m = 0.4;          // of floor; narrower than any robot
constexpr double kLeastOfBox = 0.65, kLeastOfClosedBox = 0.55, kClosed = 0.8, kLeastOfParking = 0.4, kMostForeign = 0.03, kLeastSeenSide = 0.12;

/// Bits of a cell in the picture of a room: what is there, and what of it the answer depends on.
enum RoomPicture { kIsRegion = 1, kIsForeign = 2, kIsBarrier = 4, kIsDoorway = 8, kIsSeen = 16, kBarrierMatters = 32, kForeignMatters = 64, kSeenMatters = 128 };

/// Eight cells of a row at once; beyond its end there is nothing.
std::uint64_t cells_at(const std::uint8_t* row, int x, int columns) {
  std::uint64_t cells = 0;
  if (x + 8 <= columns) std::memcpy(&cells, row + x, 8);
  else std::memcpy(&cells, row + x, static_cast<std::size_t>(columns - x));
  return cells;
}

constexpr std::uint64_t each(int bits) { return 0x0101010101010101U * static_cast<std::uint64_t>(bits); }

void put_cells(std::uint64_t cells, std::uint8_t* row, int x, int columns) {
  if (x + 8 <= columns) std::memcpy(row + x, &cells, 8);
  else std::memcpy(row + x, &cells, static_cast<std::size_t>(columns - x));
}

/// Sets a bit where the mask is set.
void set_bit(cv::Mat1b& bits, int bit, const cv::Mat1b& mask) {
  for (int y = 0; y < bits.rows; ++y) {
    std::uint8_t* row = bits[y];
    const std::uint8_t* set = mask[y];
    for (int x = 0; x < bits.cols; x += 8)
      if (const std::uint64_t cells = cells_at(set, x, bits.cols)) put_cells(cells_at(row, x, bits.cols) | (cells & each(bit)), row, x, bits.cols);
  }
}

bool is_corridor(const cv::Mat1b& mask, double area_m2, double resolution_m) {
  const double width_m = thickness_m(mask, resolution_m);
  return width_m < kCorridorWidth_m && area_m2 / (width_m * width_m) > kCorridorElongation;
}

/// Share of the region's rim that touches a barrier.
double enclosed_share(RoomPatch& patch) {
  cv::Mat1b rim, on_barrier;
  cv::morphologyEx(patch.mask, rim, cv::MORPH_GRADIENT, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  set_bit(patch.matters, kBarrierMatters, rim);
  cv::bitwise_and(rim, patch.barrier, on_barrier);
  const int all = cv::countNonZero(rim);
  return all ? static_cast<double>(cv::countNonZero(on_barrier)) / all : 0.0;
}

/// What the region runs all the way round.
cv::Mat1b holes_of(const cv::Mat1b& mask) {
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> tree;
  cv::findContours(mask, contours, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  cv::Mat1b holes(mask.size(), std::uint8_t{0});
  for (std::size_t k = 0; k < contours.size(); ++k)
    if (tree[k][3] >= 0) cv::drawContours(holes, contours, static_cast<int>(k), cv::Scalar(255), cv::FILLED);
  holes.setTo(0, mask);
  return holes;
}

/// Whether a corner of the room's box is cut off by a wall, as in bays and halls with many sides: most of its rim within the box runs askew and was hit.
/// Furniture in a corner stands along the box, and the rims of what it shades were not hit.
bool is_cut_off(const cv::Mat1b& piece, const cv::Point& corner, const std::vector<cv::Point2f>& box, RoomPatch& patch) {
  constexpr double kAskew = 0.35, kStraight_m = 0.1, kOnBox_m = 0.15, kMostly = 0.5;
  const double cell_m = patch.space.resolution_m;
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(piece, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE, corner);
  std::vector<cv::Point> ring;
  cv::approxPolyDP(contours.at(0), ring, kStraight_m / cell_m, true);
  const cv::Point2f side = box[1] - box[0];
  double within = 0, askew = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const cv::Point2f a(ring[k]), d = cv::Point2f(ring[(k + 1) % ring.size()]) - a, middle = a + 0.5F * d;
    const double length = cv::norm(d);
    if (std::abs(cv::pointPolygonTest(box, middle, true)) * cell_m < kOnBox_m) continue;
    within += length;
    const double along = std::abs(d.dot(side)), across = std::abs(d.x * side.y - d.y * side.x);
    int hit = 0, asked = 0;
    for (double s = 0.5; s < length; s += 1, ++asked) {
      const cv::Point c(a + static_cast<float>(s / length) * d);
      patch.matters(c) |= kBarrierMatters;
      hit += patch.barrier(c) > 0;
    }
    if (std::min(along, across) > kAskew * std::max(along, across) && 4 * hit > 3 * asked) askew += length;
  }
  return askew > kMostly * within;
}

/// What is larger than furniture, or cars where cars park, is space of its own that was not seen.
void drop_unlikely_pieces(cv::Mat1b& filled, const std::vector<cv::Point2f>& room_box, RoomPatch& patch) {
  const double cell_m = patch.space.resolution_m;
  const int strip = 2 * static_cast<int>(std::lround(kStrip_m / cell_m / 2)) + 1;
  const cv::Rect all = grown(box_of_set(filled), strip) & cv::Rect({0, 0}, filled.size());
  cv::Mat1b broad, piece;
  if (all.area() == 0) return;
  cv::morphologyEx(filled(all).clone(), broad, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_RECT, {strip, strip}));
  cv::Mat1i pieces, figures;
  cv::Mat1d centres;
  if (cv::countNonZero(broad) == 0) return;
  const int count = cv::connectedComponentsWithStats(broad, pieces, figures, centres, 4, CV_32S);
  for (int k = 1; k < count; ++k) {
    const cv::Rect box(figures(k, cv::CC_STAT_LEFT), figures(k, cv::CC_STAT_TOP), figures(k, cv::CC_STAT_WIDTH), figures(k, cv::CC_STAT_HEIGHT));
    cv::inRange(pieces(box), k, k, piece);
    const cv::Size2f size = cv::minAreaRect(rim_cells(piece)).size;
    const double thick_m = thickness_m(piece, cell_m), along_m = std::max(size.width, size.height) * cell_m;
    const bool likely = thick_m < kCounter_m || (thick_m < kBulky_m && (patch.parking || along_m < kBulkyLength_m));
    if (!likely || (!patch.parking && is_cut_off(piece, box.tl() + all.tl(), room_box, patch))) filled(box + all.tl()).setTo(0, piece);
  }
}

/// The region without what sticks out of it into doorways.
cv::Mat1b without_doorways(const RoomPatch& patch) {
  cv::Mat1b rest = patch.mask.clone();
  rest.setTo(0, patch.doorways);
  return rest;
}

/// Rooms are boxes more often than not. Where the region's box takes nothing of another region, and something was hit on each of its sides, the
/// rest of it is what furniture hides.
void complete_box(RoomPatch& patch, double least) {
  const cv::Mat1b region = without_doorways(patch);
  const double area = cv::countNonZero(region);
  if (area < 3) return;
  const cv::RotatedRect box = cv::minAreaRect(rim_cells(region));
  if (area < least * box.size.area()) return;
  cv::Point2f corners[4];
  box.points(corners);
  std::vector<cv::Point> ring;
  for (const cv::Point2f& p : corners) ring.emplace_back(cvRound(p.x), cvRound(p.y));
  cv::Mat1b filled(patch.mask.size(), std::uint8_t{0}), common;
  cv::polylines(filled, std::vector<std::vector<cv::Point>>{ring}, true, cv::Scalar(255), 5);
  set_bit(patch.matters, kBarrierMatters, filled);
  for (int k = 0; k < 4; ++k) {
    int hit = 0, asked = 0;
    for (double t = 0.02; t < 1; t += 0.02, ++asked) {
      const cv::Point2f p = corners[k] + static_cast<float>(t) * (corners[(k + 1) % 4] - corners[k]);
      const cv::Point c(cvRound(p.x), cvRound(p.y));
      hit += c.x >= 0 && c.y >= 0 && c.x < patch.barrier.cols && c.y < patch.barrier.rows && patch.barrier(c);
    }
    if (hit < kLeastSeenSide * asked) return;
  }
  filled.setTo(0);
  cv::fillConvexPoly(filled, ring, cv::Scalar(255));
  set_bit(patch.matters, kForeignMatters, filled);
  cv::bitwise_and(filled, patch.foreign, common);
  if (cv::countNonZero(common) > kMostForeign * cv::countNonZero(filled)) return;
  filled.setTo(0, patch.foreign);
  filled.setTo(0, holes_of(patch.mask));
  filled.setTo(0, patch.mask);
  drop_unlikely_pieces(filled, {corners, corners + 4}, patch);
  cv::bitwise_or(patch.mask, filled, patch.mask);
}

/// Share of its box that a region must fill for the rest to be hidden floor; where nearly all of the outline was hit, furniture may hide more.
double least_of_box(const RoomPatch& patch, double enclosed) {
  if (patch.parking) return kLeastOfParking;
  return enclosed >= kClosed ? kLeastOfClosedBox : kLeastOfBox;
}

/// What beams showed through a window or a slit hangs on a room by a neck that nobody passes. @return whether something was left out.
bool leave_out_behind_necks(RoomPatch& patch) {
  const int neck = 2 * static_cast<int>(std::lround(kNeck_m / 2 / patch.space.resolution_m)) + 1;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {neck, neck});
  cv::Mat1b core;
  cv::erode(patch.mask, core, disc, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat1i pieces, figures;
  cv::Mat1d centres;
  const int count = cv::connectedComponentsWithStats(core, pieces, figures, centres, 8, CV_32S);
  if (count < 3) return false;
  int largest = 1;
  for (int k = 2; k < count; ++k)
    if (figures(k, cv::CC_STAT_AREA) > figures(largest, cv::CC_STAT_AREA)) largest = k;
  cv::inRange(pieces, largest, largest, core);
  cv::dilate(core, core, disc);
  cv::bitwise_and(core, patch.mask, patch.mask);
  return true;
}

}  // namespace

bool make_room(RoomPatch& patch, const RoomOptions& options, Room& room) {
  room.evidence = enclosed_share(patch);
  const double least = patch.glimpse ? options.glimpse_enclosed : options.min_enclosed;
  if (patch.glimpse && room.evidence < least && leave_out_behind_necks(patch)) room.evidence = enclosed_share(patch);
  if (room.evidence < least) return false;
  complete_box(patch, least_of_box(patch, room.evidence));
  room.outline = outline_of(patch.mask, patch.space, kMinHole_m2, kTolerance_m);
  if (room.outline.size() < 3) return false;
  std::vector<cv::Point> ring;
  for (const Eigen::Vector2d& p : room.outline) ring.push_back(patch.space.cell(p));
  cv::Mat1b filled(patch.mask.size(), std::uint8_t{0}), seen;
  cv::fillPoly(filled, std::vector<std::vector<cv::Point>>{ring}, cv::Scalar(255));
  cv::bitwise_and(patch.seen, filled, seen);
  set_bit(patch.matters, kSeenMatters, filled);
  const double inside = cv::countNonZero(filled);
  room.explored = inside > 0 ? cv::countNonZero(seen) / inside : 0.0;
  room.area_m2 = polygon_area_m2(room.outline);
  room.corridor = is_corridor(patch.mask, room.area_m2, patch.space.resolution_m);
  return room.area_m2 >= options.min_area_m2 && room.explored >= options.min_explored;
}

cv::Mat1b picture_of(const RoomPatch& patch) {
  cv::Mat1b picture(patch.mask.size(), std::uint8_t{0});
  set_bit(picture, kIsRegion, patch.mask);
  set_bit(picture, kIsForeign, patch.foreign);
  set_bit(picture, kIsBarrier, patch.barrier);
  set_bit(picture, kIsDoorway, patch.doorways);
  set_bit(picture, kIsSeen, patch.seen);
  return picture;
}

bool says_the_same(const cv::Mat1b& known, const cv::Mat1b& other) {
  if (known.size() != other.size()) return false;
  for (int y = 0; y < known.rows; ++y) {
    const std::uint8_t *row = known[y], *other_row = other[y];
    for (int x = 0; x < known.cols; x += 8) {
      const std::uint64_t before = cells_at(row, x, known.cols), differs = before ^ cells_at(other_row, x, known.cols);
      const std::uint64_t matters = each(kIsRegion) | (before << 3 & each(kIsDoorway)) | (before >> 3 & each(kIsBarrier)) | (before >> 5 & each(kIsForeign)) | (before >> 3 & each(kIsSeen));
      if (differs & matters) return false;
    }
  }
  return true;
}

}  // namespace modslam
