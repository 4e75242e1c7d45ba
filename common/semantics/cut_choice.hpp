// SPDX-License-Identifier: BSD-3-Clause
/// @file Which openings are cut: the surest first, none that says the same as one before.
#pragma once
#include <tuple>
#include <vector>

#include "common/semantics/openings.hpp"
#include "common/semantics/plan_index.hpp"

namespace modslam {

/// An opening that was cut, and the regions on its two sides (left and right of a -> b; 0: none).
struct CutOpening {
  Opening opening;
  int left = 0, right = 0;
  bool parts() const { return left != 0 && right != 0 && left != right; }
};

/// Keeps the choice in step with the openings: looked at again is what came, and what lies near a choice that changed. The result is the one of a fresh look.
class CutChoice {
 public:
  /// @param openings  surest first. @return places in it of the chosen ones, rising.
  const std::vector<std::size_t>& update(const std::vector<Opening>& openings);

 private:
  struct Slot {
    Opening opening;
    bool chosen = false;
    auto order() const { return std::tuple(-opening.probability, opening.a.x(), opening.a.y(), opening.b.x(), opening.b.y()); }
  };
  /// An opening of which the choice changed.
  struct Stirred {
    Eigen::Vector2d centre;
    double half_m;
  };
  std::size_t take(const Opening& opening);
  void drop(std::size_t slot);
  bool is_stirred(const Opening& opening) const;
  void choose(std::size_t slot);

  static constexpr double kSquare_m = 3.5;
  std::vector<Slot> slots_;
  std::vector<std::size_t> free_, listed_, chosen_;   ///< listed_: slots of the openings, surest first
  PlanIndex index_{kSquare_m};
  std::vector<Stirred> stirred_;                      ///< in this round
};

}  // namespace modslam
