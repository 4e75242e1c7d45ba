// SPDX-License-Identifier: BSD-3-Clause
/// @file Straight faces that are no walls: fronts and sides of what stands before a wall, and small groups of faces that stand alone.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "common/semantics/wall_set.hpp"

namespace modslam {

/// A longer straight face is a wall whatever seems to lie behind it, unless wall is seen in line at both its ends, behind it: a counter.
constexpr double kLongestFront_m = 5.5;

/// A box of the plan, with sides along x and y [m].
struct PlanBox {
  Eigen::Vector2d low, high;
};

/// Keeps its answers in step with the walls: worked out anew is only what lies near a change. They are what all of it at once would give.
class FurnitureMap {
 public:
  /// Whether the floor was seen free at a place: behind the front of a cupboard nothing was.
  using IsFree = std::function<bool(const Eigen::Vector2d&)>;

  /// @param news  of the walls that are looked at, by number. @param changed  where answers of is_free may be new since the last call.
  /// @return numbers whose answers may be new, some more than once.
  Numbers update(const NumberNews& news, const Slots<Wall>& walls, const IsFree& is_free, const std::vector<PlanBox>& changed);
  bool is_furniture(std::size_t number) const { return is_part(number) || lone_[number]; }
  const WallSet& walls() const { return walls_; }

  /// Footprints of what stands before walls and is no floor: corners of the boxes from the fronts to the walls behind, deepest first. Front's length is
  /// from corner 0 to 1. @param is_free  as in the update before.
  std::vector<std::array<Eigen::Vector2d, 4>> footprints(const IsFree& is_free);

 private:
  /// What a front hides: from the line of the wall behind it up to itself.
  struct Niche {
    Eigen::Vector2d origin, along, out;  ///< a place on the wall's line; along it; towards the front
    double low, high, depth;
    bool holds(const Eigen::Vector2d& p) const;
    PlanBox box() const;
    std::array<Eigen::Vector2d, 4> ring() const;
    bool operator==(const Niche& o) const { return origin == o.origin && along == o.along && low == o.low && high == o.high && depth == o.depth; }
  };

  std::optional<Niche> niche_of(const Wall& front, const IsFree& is_free) const;
  bool is_wall_behind(const Wall& front, const Wall& back, const Niche& niche) const;
  bool is_side(const Wall& wall) const;
  bool is_part(std::size_t number) const { return front_[number] || side_[number]; }
  void set_niche(std::size_t number, const std::optional<Niche>& niche);
  Numbers near(const std::vector<PlanBox>& boxes, double margin_m) const;
  void find_fronts(const Numbers& numbers, const IsFree& is_free, std::vector<PlanBox>& stirred);
  void find_sides(const Numbers& numbers, std::vector<PlanBox>& stirred);
  Numbers group_of(std::size_t first, PlanBox& box) const;
  bool is_piece_of_wall(const Numbers& group) const;
  void find_lone_groups(const Numbers& numbers);
  bool is_large() const;

  WallSet walls_;
  std::vector<std::optional<Niche>> niches_;   ///< by number of the front
  std::vector<char> front_, side_, lone_;      ///< by number; front_: it has a niche
  std::vector<std::optional<double>> floor_;   ///< by number of the front: share of its footprint that is floor, when asked
  Numbers fronts_;
  Numbers touched_;                            ///< whose answers may be new in this round
  PlanIndex niche_index_{3.2};
  bool was_large_ = false;
};

/// Share of a rectangle that was seen to be floor.
double floor_share(const std::array<Eigen::Vector2d, 4>& ring, const FurnitureMap::IsFree& is_free);

/// All at once: one flag a wall.
std::vector<bool> find_furniture(const std::vector<Wall>& walls, const FurnitureMap::IsFree& is_free);

}  // namespace modslam
