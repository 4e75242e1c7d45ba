// SPDX-License-Identifier: BSD-3-Clause
/// @file One-to-one assignment of least total cost (the Hungarian method).
#pragma once
#include <Eigen/Core>
#include <vector>

namespace modslam {

/// @param cost  rows x columns, finite. @return for each row its column, or -1; min(rows, columns)
/// rows get one. Cost: O(n^3). Source: Kuhn 1955, in the shortest-augmenting-path form of Jonker
/// and Volgenant 1987.
std::vector<int> assign(const Eigen::MatrixXd& cost);

}  // namespace modslam
