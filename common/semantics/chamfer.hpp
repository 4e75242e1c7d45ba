// SPDX-License-Identifier: BSD-3-Clause
/// @file Distances in a mask, as OpenCV's distanceTransform() gives them, for less: the steps from row to row are taken for many cells at once.
#pragma once
#include <opencv2/core.hpp>

namespace modslam {

/// Distance of each set cell to the nearest that is not set [cells], at most `most`: DIST_L2 with a mask of 5. What lies beyond the picture does not count.
cv::Mat1f distances(const cv::Mat1b& mask, float most);

/// The largest distance to a cell that is not set [cells]: DIST_L2 with a mask of 3. Nothing beyond the picture is set.
float deepest(const cv::Mat1b& mask);

}  // namespace modslam
