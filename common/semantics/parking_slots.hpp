// SPDX-License-Identifier: BSD-3-Clause
/// @file Gaps between parked cars: dead ends as wide as their mouths with a car's width of closed space beside them. They are no rooms.
#pragma once
#include <functional>
#include <set>
#include <vector>

#include "common/semantics/cut_choice.hpp"
#include "common/semantics/memo.hpp"
#include "common/semantics/tiled_regions.hpp"

namespace modslam {

/// Keeps what dead ends look like as boxes until the floor changes there.
class ParkingSlots {
 public:
  using MaskOf = std::function<cv::Mat1b(int)>;

  /// Call before find(). @param changed  where the parted floor is new.
  void forget(const Boxes& changed) { niches_.forget(changed); }
  void grow(const Growth& growth);
  /// @param cuts  with regions at their sides; region k, from 1, stands at k - 1. @param numbers  at k: stays as long as the region stays the same.
  /// @param mask_of  the cells of a region within its box. @return the regions that are slots.
  std::set<int> find(const std::vector<CutOpening>& cuts, const std::vector<Region>& regions, const std::vector<int>& numbers, const Floor& floor,
                     const MaskOf& mask_of);

 private:
  /// A dead end as a box.
  struct Niche {
    Eigen::Vector2d centre, across;  ///< across: along its short sides
    double width, depth;             ///< [cells]
  };
  static Niche niche_of(const cv::Mat1b& mask, const cv::Point& corner);

  Memo<int, Niche> niches_;
};

}  // namespace modslam
