// SPDX-License-Identifier: BSD-3-Clause
/// @file Straight faces that are no walls: fronts and sides of what stands before a wall, and small groups of faces that stand alone.
#pragma once
#include <functional>
#include <vector>

#include "common/semantics/types.hpp"

namespace modslam {

/// @param is_free whether the floor was seen free at a place: behind the front of a cupboard nothing was. @return one flag a wall.
/// Cost by the number of walls.
std::vector<bool> find_furniture(const std::vector<Wall>& walls, const std::function<bool(const Eigen::Vector2d&)>& is_free);

}  // namespace modslam
