// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/boxes.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

namespace modslam {

bool meet(const Boxes& boxes, const cv::Rect& box) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const cv::Rect& other) { return meet(other, box); });
}

Boxes windows(const Boxes& boxes, int cells, const cv::Size& frame) {
  Boxes out;
  for (const cv::Rect& box : boxes) {
    cv::Rect window = grown(box, cells) & cv::Rect({0, 0}, frame);
    // One window costs less than two that overlap.
    for (std::size_t k = 0; k < out.size();) {
      const cv::Rect both = out[k] | window;
      if (both.area() > out[k].area() + window.area()) {
        ++k;
        continue;
      }
      window = both;
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(k));
      k = 0;
    }
    if (window.area() > 0) out.push_back(window);
  }
  return out;
}

namespace {

/// Box around the cells of rows for which `first_last` finds any: it is given a row and sets the first and last of its bytes that count.
template <class FirstLast>
cv::Rect box_of_rows(const cv::Mat& raster, FirstLast first_last) {
  std::ptrdiff_t low = std::numeric_limits<std::ptrdiff_t>::max(), high = -1;
  int top = -1, bottom = -1;
  for (int y = 0; y < raster.rows; ++y) {
    std::ptrdiff_t first = 0, last = -1;
    if (!first_last(y, first, last)) continue;
    low = std::min(low, first);
    high = std::max(high, last);
    top = top < 0 ? y : top;
    bottom = y;
  }
  if (top < 0) return {};
  const auto bytes = static_cast<std::ptrdiff_t>(raster.elemSize());
  return {cv::Point(static_cast<int>(low / bytes), top), cv::Point(static_cast<int>(high / bytes) + 1, bottom + 1)};
}

}  // namespace

// cv::boundingRect() of OpenCV 4.6 leaves out cells of some masks.
cv::Rect difference(const cv::Mat& p, const cv::Mat& q) {
  const std::size_t bytes = p.elemSize() * static_cast<std::size_t>(p.cols);
  return box_of_rows(p, [&](int y, std::ptrdiff_t& first, std::ptrdiff_t& last) {
    const uchar *a = p.ptr(y), *b = q.ptr(y), *end = a + bytes;
    if (std::memcmp(a, b, bytes) == 0) return false;
    first = std::mismatch(a, end, b).first - a;
    for (last = static_cast<std::ptrdiff_t>(bytes) - 1; a[last] == b[last];) --last;
    return true;
  });
}

cv::Rect box_of_set(const cv::Mat1b& mask) {
  const auto is_set = [](std::uint8_t cell) { return cell != 0; };
  return box_of_rows(mask, [&](int y, std::ptrdiff_t& first, std::ptrdiff_t& last) {
    const std::uint8_t *row = mask[y], *end = row + mask.cols;
    const bool all_alike = std::memcmp(row, row + 1, static_cast<std::size_t>(mask.cols - 1)) == 0;
    if (all_alike && *row == 0) return false;
    first = std::find_if(row, end, is_set) - row;
    for (last = mask.cols - 1; !is_set(row[last]);) --last;
    return true;
  });
}

void take_over(cv::Mat whole, const cv::Rect& box, const cv::Mat& picture, Boxes& changed) {
  cv::Mat part = whole(box);
  const cv::Rect news = difference(part, picture);
  if (news.area() == 0) return;
  picture(news).copyTo(part(news));
  changed.push_back(news + box.tl());
}

}  // namespace modslam
