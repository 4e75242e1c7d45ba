// SPDX-License-Identifier: BSD-3-Clause
/// @file Which gaps are cut: the surest first, none that says the same as one before.
#pragma once
#include <set>
#include <utility>
#include <vector>

#include "common/semantics/openings.hpp"
#include "common/semantics/plan_index.hpp"
#include "common/semantics/slots.hpp"

namespace modslam {

/// A gap that was cut, and the regions on its two sides (left and right of a -> b; 0: none).
struct CutOpening {
  Gap opening;
  std::size_t number = 0;   ///< stays as long as the cut
  int left = 0, right = 0;
  bool parts() const { return left != 0 && right != 0 && left != right; }
};

/// Keeps the choice in step with the gaps: looked at again is what came, and what lies near a choice that changed. The result is the one of a fresh look.
class CutChoice {
 public:
  /// @return news of the chosen.
  NumberNews update(const GapNews& news);

  /// Numbers of the chosen, surest first.
  const Numbers& chosen() const { return chosen_; }
  /// What is gone can be read until the next update.
  const Gap& operator[](std::size_t number) const { return slots_[number].gap; }
  /// All numbers are below this.
  std::size_t end() const { return slots_.end(); }
  /// Chosen ones that may lie within `margin_m` of a box with corners p and q, lowest number first.
  Numbers near(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m) const;

 private:
  struct Slot {
    Gap gap;
    bool chosen = false;
  };
  using Order = decltype(Gap().order());
  using Queue = std::set<std::pair<Order, std::size_t>>;   ///< to be looked at, surest first
  std::size_t find(const Gap& gap) const;
  void ask_less_sure(std::size_t number, Queue& queue) const;
  bool is_best(std::size_t number) const;
  Numbers::iterator place_of(std::size_t number);

  static constexpr double kSquare_m = 3.5, kReach_m = 0.5 * kSquare_m;
  Slots<Slot> slots_;
  Numbers chosen_;
  PlanIndex index_{kSquare_m};
};

}  // namespace modslam
