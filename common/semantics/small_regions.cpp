// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/small_regions.hpp"

#include <map>

namespace modslam {
namespace {

/// Joins regions that are too small, the smallest first, to a neighbour through the least sure of these ways. Each round makes one region fewer.
template <class IsSmall>
void join_smallest_first(const std::vector<const CutOpening*>& ways, JoinedRegions& regions, IsSmall is_small) {
  for (;;) {
    int smallest = 0;
    const CutOpening* way = nullptr;
    for (const CutOpening* cut : ways) {
      const int left = regions.root(cut->left), right = regions.root(cut->right);
      if (left == right) continue;
      for (const int side : {left, right}) {
        if (!is_small(side)) continue;
        const bool better = !way || regions.area_m2(side) < regions.area_m2(smallest) ||
                            (side == smallest && cut->opening.probability < way->opening.probability);
        if (better) smallest = side, way = cut;
      }
    }
    if (!way) return;
    regions.join(way->left, way->right);
  }
}

}  // namespace

/// Small regions that no chain of small neighbours joins know nothing of each other: each such group is joined on its own.
void join_small_regions(const std::vector<CutOpening>& cuts, double min_room_m2, JoinedRegions& regions) {
  const auto is_small = [&](int region) { return regions.area_m2(region) < min_room_m2; };
  std::vector<const CutOpening*> ways;  // out of regions that are too small; no others become so
  for (const CutOpening& cut : cuts)
    if (cut.left && cut.right && (is_small(cut.left) || is_small(cut.right))) ways.push_back(&cut);
  JoinedRegions chains = regions;
  for (const CutOpening* way : ways)
    if (is_small(way->left) && is_small(way->right)) chains.join(way->left, way->right);
  std::map<int, std::vector<const CutOpening*>> groups;
  for (const CutOpening* way : ways) groups[chains.root(is_small(way->left) ? way->left : way->right)].push_back(way);
  for (const auto& [group, those] : groups) join_smallest_first(those, regions, is_small);
}

}  // namespace modslam
