// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/parking_slots.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr double kSlotDepth_m = 2.5, kMostSlotDepth_m = 6.5, kSlotMouth = 0.8;
constexpr double kCarFrom_m = 1.2, kCarTo_m = 2.6;
constexpr double kSameWay = 0.7;  // |cos| between the mouth of a slot and its short sides

/// As wide all the way as its mouth, and deep.
bool is_slot(double width_m, double depth_m, const Vec& across, const Gap& mouth) {
  const Vec u = (mouth.b - mouth.a).normalized();
  return depth_m > kSlotDepth_m && depth_m < kMostSlotDepth_m && depth_m > 1.5 * width_m && std::abs(u.dot(across)) > kSameWay &&
         mouth.width_m() > kSlotMouth * width_m;
}

/// Thickness of what stands beside a slot, half way in, along `across`. 0: more than a car's width.
double beside_m(const Vec& centre, const Vec& across, double width, const Floor& floor) {
  for (double s = 0.5 * width + 1; s < 0.5 * width + kCarTo_m / floor.resolution_m + 2; s += 0.5) {
    const Vec p = centre + s * across;
    const cv::Point c(cvRound(p.x()), cvRound(p.y()));
    if (c.x >= 0 && c.y >= 0 && c.x < floor.open.cols && c.y < floor.open.rows && floor.open(c)) return (s - 0.5 * width) * floor.resolution_m;
  }
  return 0;
}

}  // namespace

ParkingSlots::Niche ParkingSlots::niche_of(const cv::Mat1b& mask, const cv::Point& corner) {
  std::vector<cv::Point> rim = rim_cells(mask);
  for (cv::Point& c : rim) c += corner;
  const cv::RotatedRect box = cv::minAreaRect(rim);
  const bool first_is_short = box.size.width < box.size.height;
  const double angle = box.angle * CV_PI / 180 + (first_is_short ? 0 : CV_PI / 2);
  return {Vec(box.center.x, box.center.y), Vec(std::cos(angle), std::sin(angle)), std::min(box.size.width, box.size.height) + 1.0,
          std::max(box.size.width, box.size.height) + 1.0};
}

void ParkingSlots::grow(const Growth& growth) {
  niches_.grow(growth, [&](Niche& niche) { niche.centre += Vec(growth.shift.x, growth.shift.y); });
}

std::set<int> ParkingSlots::find(const std::vector<CutOpening>& cuts, const std::vector<Region>& regions, const std::vector<int>& numbers, const Floor& floor,
                                 const MaskOf& mask_of) {
  const double cell_m = floor.resolution_m;
  std::vector<int> ways(regions.size() + 1, 0);
  std::vector<const CutOpening*> mouths(ways.size(), nullptr);
  for (const CutOpening& cut : cuts)
    if (cut.parts())
      for (const int side : {cut.left, cut.right}) ++ways[static_cast<std::size_t>(side)], mouths[static_cast<std::size_t>(side)] = &cut;
  std::set<int> slots;
  for (int number = 1; number < static_cast<int>(ways.size()); ++number) {
    const Region& region = regions[static_cast<std::size_t>(number - 1)];
    if (ways[static_cast<std::size_t>(number)] != 1 || region.cells * cell_m * cell_m >= kMostSlotDepth_m * kMostSlotDepth_m / 1.5) continue;
    const auto look = [&] { return niche_of(mask_of(number), region.box.tl()); };
    const Niche& niche = niches_.ask(numbers[static_cast<std::size_t>(number)], region.box, look);
    if (!is_slot(niche.width * cell_m, niche.depth * cell_m, niche.across, mouths[static_cast<std::size_t>(number)]->opening)) continue;
    const bool beside_car = beside_m(niche.centre, niche.across, niche.width, floor) >= kCarFrom_m || beside_m(niche.centre, -niche.across, niche.width, floor) >= kCarFrom_m;
    if (beside_car) slots.insert(number);
  }
  return slots;
}

}  // namespace modslam
