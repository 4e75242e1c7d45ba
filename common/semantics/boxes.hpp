// SPDX-License-Identifier: BSD-3-Clause
/// @file Boxes of cells, to say where a raster changed and what must be looked at again for it.
#pragma once
#include <cstring>
#include <opencv2/core.hpp>
#include <vector>

namespace modslam {

using Boxes = std::vector<cv::Rect>;

inline cv::Rect grown(const cv::Rect& box, int cells) { return {box.x - cells, box.y - cells, box.width + 2 * cells, box.height + 2 * cells}; }

inline bool meet(const cv::Rect& p, const cv::Rect& q) { return (p & q).area() > 0; }

inline cv::Rect bounds(const Boxes& boxes) {
  cv::Rect all;
  for (const cv::Rect& box : boxes) all |= box;
  return all;
}

bool meet(const Boxes& boxes, const cv::Rect& box);

/// Boxes grown by so many cells and cut off at the frame; those that share much become one.
Boxes windows(const Boxes& boxes, int cells, const cv::Size& frame);

/// The first cell of a row with this value; `end`: none.
inline const std::uint8_t* find_cell(const std::uint8_t* at, const std::uint8_t* end, int value) {
  const void* found = std::memchr(at, value, static_cast<std::size_t>(end - at));
  return found ? static_cast<const std::uint8_t*>(found) : end;
}

/// Box around the cells in which two pictures of one size differ; empty: they do not.
cv::Rect difference(const cv::Mat& p, const cv::Mat& q);

/// Box around the cells that are not 0; empty: there are none.
cv::Rect box_of_set(const cv::Mat1b& mask);

/// The frame of a raster that grew: where its cells stand now, and its size.
struct Growth {
  cv::Point shift;
  cv::Size size;
};

/// A raster that grew, with `value` in its new cells.
template <class Raster>
Raster grown(const Raster& before, const Growth& growth, typename Raster::value_type value) {
  Raster out(growth.size, value);
  before.copyTo(out(cv::Rect(growth.shift, before.size())));
  return out;
}

/// Takes the picture over into `whole` at `box`, and notes where that changed it.
void take_over(cv::Mat whole, const cv::Rect& box, const cv::Mat& picture, Boxes& changed);

}  // namespace modslam
