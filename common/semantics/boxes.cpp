// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/boxes.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

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

cv::Rect difference(const cv::Mat& p, const cv::Mat& q) {
  cv::Mat1b differs;
  cv::compare(p, q, differs, cv::CMP_NE);
  return cv::boundingRect(differs);
}

void take_over(cv::Mat whole, const cv::Rect& box, const cv::Mat& picture, Boxes& changed) {
  cv::Mat part = whole(box);
  const cv::Rect news = difference(part, picture);
  if (news.area() == 0) return;
  picture(news).copyTo(part(news));
  changed.push_back(news + box.tl());
}

}  // namespace modslam
