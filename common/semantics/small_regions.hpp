// SPDX-License-Identifier: BSD-3-Clause
/// @file Regions of the floor that are too small to be rooms join what lies beside them.
#pragma once
#include <utility>
#include <vector>

#include "common/graph/disjoint_sets.hpp"
#include "common/semantics/cut_choice.hpp"

namespace modslam {

/// Regions, some of which became one, with the area of what they are in.
class JoinedRegions {
 public:
  explicit JoinedRegions(std::vector<double> area_m2) : sets_(area_m2.size()), area_m2_(std::move(area_m2)) {}
  /// The region that stands for all that this one was joined with.
  int root(int k) const { return static_cast<int>(sets_.root(static_cast<std::size_t>(k))); }
  double area_m2(int k) const { return area_m2_[static_cast<std::size_t>(root(k))]; }
  /// What the second stands for stands for both.
  void join(int p, int q) {
    const auto goes = static_cast<std::size_t>(root(p)), stays = static_cast<std::size_t>(root(q));
    if (goes == stays) return;
    sets_.join(goes, stays);
    area_m2_[stays] += area_m2_[goes];
  }

 private:
  DisjointSets sets_;
  std::vector<double> area_m2_;
};

/// Joins regions smaller than a room, the smallest first, each to a neighbour through the least sure of the cuts between them. @param cuts  with regions at
/// their sides.
void join_small_regions(const std::vector<CutOpening>& cuts, double min_room_m2, JoinedRegions& regions);

}  // namespace modslam
