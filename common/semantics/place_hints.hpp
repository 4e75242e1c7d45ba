// SPDX-License-Identifier: BSD-3-Clause
/// @file What the rooms and doors of the map say of a place.
#pragma once
#include "common/places/place.hpp"
#include "common/semantics/plan_index.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

class PlaceHints {
 public:
  /// @param layers  outlives this.
  explicit PlaceHints(const SemanticLayers& layers);
  /// At a door: within 0.4 m of the line between its jambs. In a room or corridor: within its outline.
  PlaceOnMap at(const Eigen::Vector2d& p) const;

 private:
  const SemanticLayers& layers_;
  PlanIndex doors_, rooms_;
};

}  // namespace modslam
