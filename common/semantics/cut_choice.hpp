// SPDX-License-Identifier: BSD-3-Clause
/// @file Which openings the floor is cut at.
#pragma once
#include <vector>

#include "common/semantics/openings.hpp"

namespace modslam {

/// An opening that was cut, and the regions on its two sides (left and right of a -> b; 0: none).
struct CutOpening {
  Opening opening;
  int left = 0, right = 0;
};

/// The surest first, none that says the same as one before: side by side with it or across. @param openings  surest first.
std::vector<CutOpening> choose_cuts(const std::vector<Opening>& openings, const CutLimits& limits);

}  // namespace modslam
