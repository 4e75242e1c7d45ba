// SPDX-License-Identifier: BSD-3-Clause
/// @file Walls by number, with an index over the plan: who asks about a place meets only the walls near it.
#pragma once
#include <array>
#include <unordered_map>

#include "common/semantics/plan_index.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

/// A wall keeps its number as long as its ends stay the same, to the bit. Numbers say nothing about order.
class WallSet {
 public:
  /// Numbers. What is gone can be read until the next update.
  struct News {
    std::vector<std::size_t> gone, come;
    bool empty() const { return gone.empty() && come.empty(); }
  };

  News update(const std::vector<Wall>& walls);

  /// Of the walls of the last update, in their order.
  const std::vector<std::size_t>& numbers() const { return numbers_; }
  const Wall& operator[](std::size_t number) const { return walls_[number]; }
  std::size_t size() const { return numbers_.size(); }
  /// All numbers, also of walls that are gone, are below this.
  std::size_t end() const { return walls_.size(); }
  /// Walls that may lie within `margin_m` of a box with corners p and q.
  std::vector<std::size_t> near(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m) const { return index_.near(p, q, margin_m); }
  /// The same, visited in no order, some more than once.
  template <class Visit>
  void each_near(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m, Visit visit) const {
    index_.each_near(p, q, margin_m, visit);
  }

 private:
  using Ends = std::array<double, 4>;
  struct Hash {
    std::size_t operator()(const Ends& ends) const;
  };
  static constexpr double kSquare_m = 3.2;
  static Ends ends_of(const Wall& wall) { return {wall.a.x(), wall.a.y(), wall.b.x(), wall.b.y()}; }
  std::size_t number_for(const Wall& wall);

  std::vector<Wall> walls_;
  std::vector<std::size_t> numbers_, places_, free_, gone_;   ///< places_: of a number in numbers_, when it was last there
  std::unordered_map<Ends, std::size_t, Hash> number_of_;
  PlanIndex index_{kSquare_m};
};

}  // namespace modslam
