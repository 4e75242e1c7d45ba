// SPDX-License-Identifier: BSD-3-Clause
/// @file Objects: what stands free in known floor. Cars and pillars are among them; their faces are no walls.
#pragma once
#include <vector>

#include "common/semantics/known_space.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct ObjectMap {
  std::vector<Object> objects;
  cv::Mat1b mask;  ///< cells that belong to an object, on the grid of the known space
};

/// Islands of not-free cells, surrounded by free floor, of at most max_m2.
ObjectMap find_objects(const KnownSpace& space, double max_m2);

}  // namespace modslam
