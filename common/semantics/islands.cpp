// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/islands.hpp"

#include <opencv2/imgproc.hpp>

namespace modslam {

void each_island(const cv::Mat1b& mask, const Boxes& changed, int longest, int connectivity, const std::function<void(const Island&)>& visit) {
  const Boxes touched = windows(changed, 1, mask.size());
  for (const cv::Rect& window : windows(touched, longest + 1, mask.size())) {
    cv::Mat1i labels, statistics;
    cv::Mat1d centres;
    const int count = cv::connectedComponentsWithStats(mask(window), labels, statistics, centres, connectivity, CV_32S);
    std::vector<bool> asked(static_cast<std::size_t>(count), false);
    for (const cv::Rect& box : touched) {
      const cv::Rect part = (box & window) - window.tl();
      for (int y = part.y; y < part.br().y; ++y)
        for (const int* label = labels[y] + part.x; label != labels[y] + part.br().x; ++label) asked[static_cast<std::size_t>(*label)] = true;
    }
    for (int k = 1; k < count; ++k) {
      const cv::Rect box(statistics(k, cv::CC_STAT_LEFT), statistics(k, cv::CC_STAT_TOP), statistics(k, cv::CC_STAT_WIDTH), statistics(k, cv::CC_STAT_HEIGHT));
      const bool at_rim = box.x == 0 || box.y == 0 || box.br().x == window.width || box.br().y == window.height;
      if (!asked[static_cast<std::size_t>(k)] || at_rim || std::max(box.width, box.height) > longest) continue;
      Island island{box + window.tl(), {}, statistics(k, cv::CC_STAT_AREA)};
      cv::inRange(labels(box), k, k, island.mask);
      visit(island);
    }
  }
}

}  // namespace modslam
