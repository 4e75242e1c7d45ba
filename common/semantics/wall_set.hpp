// SPDX-License-Identifier: BSD-3-Clause
/// @file Some of the walls that have numbers, with an index over the plan: who asks about a place meets only the walls near it.
#pragma once
#include "common/semantics/plan_index.hpp"
#include "common/semantics/slots.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

/// Of a wall its line counts here; what else is known of it is what was known when it came.
class WallSet {
 public:
  WallSet() = default;
  /// All at once: the walls' numbers are their places in the list.
  explicit WallSet(const std::vector<Wall>& walls);

  void take(const NumberNews& news, const Slots<Wall>& walls);

  bool has(std::size_t number) const { return number < is_in_.size() && is_in_[number]; }
  /// Rising.
  Numbers numbers() const;
  const Wall& operator[](std::size_t number) const { return walls_[number]; }
  std::size_t size() const { return size_; }
  /// All numbers, also of walls that are gone, are below this.
  std::size_t end() const { return walls_.size(); }
  /// Walls that may lie within `margin_m` of a box with corners p and q, lowest number first.
  Numbers near(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m) const { return index_.near(p, q, margin_m); }
  /// The same, visited in no order, some more than once.
  template <class Visit>
  void each_near(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m, Visit visit) const {
    index_.each_near(p, q, margin_m, visit);
  }

 private:
  static constexpr double kSquare_m = 3.2;
  void put(std::size_t number, const Wall& wall);
  void drop(std::size_t number);

  std::vector<Wall> walls_;
  std::vector<char> is_in_;
  std::size_t size_ = 0;
  PlanIndex index_{kSquare_m};
};

}  // namespace modslam
