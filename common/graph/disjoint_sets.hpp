// SPDX-License-Identifier: BSD-3-Clause
/// @file Numbers in sets that are joined two by two.
#pragma once
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace modslam {

/// Union-find with path halving (Tarjan and van Leeuwen 1984). At first each of the numbers 0 .. count - 1 is a set of its own.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  std::size_t size() const { return parent_.size(); }
  /// The number that stands for the set.
  std::size_t root(std::size_t k) const {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  /// The root of the second stands for both.
  void join(std::size_t goes, std::size_t stays) { parent_[root(goes)] = root(stays); }
  /// The lower root stands for both: the lowest number of the set, if all are joined so.
  void join_lowest(std::size_t p, std::size_t q) {
    const std::size_t a = root(p), b = root(q);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  mutable std::vector<std::size_t> parent_;  ///< ways to the roots grow shorter as they are asked for
};

}  // namespace modslam
