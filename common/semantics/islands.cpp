// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/islands.hpp"

#include <array>

namespace modslam {
namespace {

enum Mark : std::uint8_t { kUnseen, kSmall, kLarge };

/// Floods connected sets from single cells, and gives a set up as soon as it is too large or meets one that was.
class Flood {
 public:
  Flood(const cv::Mat1b& mask, const IslandLimits& limits) : mask_(mask), limits_(limits), marks_(mask.size(), std::uint8_t{kUnseen}) {}

  bool seen(const cv::Point& c) const { return marks_(c) != kUnseen; }

  /// Fills in cells_ and box_. @return whether it is an island.
  bool from(const cv::Point& seed) {
    static const std::array<cv::Point, 8> kSteps{cv::Point(1, 0), {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
    cells_.assign(1, seed);
    marks_(seed) = kSmall;
    cv::Point low = seed, high = seed;
    bool large = false;
    for (std::size_t next = 0; next < cells_.size() && !large; ++next) {
      const cv::Point at = cells_[next];
      low = {std::min(low.x, at.x), std::min(low.y, at.y)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y)};
      large = at.x == 0 || at.y == 0 || at.x + 1 == mask_.cols || at.y + 1 == mask_.rows || high.x - low.x >= limits_.longest || high.y - low.y >= limits_.longest ||
              static_cast<int>(cells_.size()) > limits_.most_cells;
      for (int k = 0; k < limits_.connectivity && !large; ++k) {
        const cv::Point c = at + kSteps[static_cast<std::size_t>(k)];
        if (!mask_(c) || marks_(c) == kSmall) continue;
        large = marks_(c) == kLarge;
        marks_(c) = kSmall;
        cells_.push_back(c);
      }
    }
    box_ = cv::Rect(low, high + cv::Point(1, 1));
    if (large)
      for (const cv::Point& c : cells_) marks_(c) = kLarge;
    return !large;
  }

  Island island(const cv::Point& corner) const {
    Island out{box_ + corner, cv::Mat1b(box_.size(), std::uint8_t{0}), static_cast<int>(cells_.size())};
    for (const cv::Point& c : cells_) out.mask(c - box_.tl()) = 255;
    return out;
  }

 private:
  cv::Mat1b mask_;
  IslandLimits limits_;
  cv::Mat1b marks_;
  std::vector<cv::Point> cells_;
  cv::Rect box_;
};

}  // namespace

void each_island(const cv::Mat1b& mask, const Boxes& changed, const IslandLimits& limits, const std::function<void(const Island&)>& visit) {
  const Boxes touched = windows(changed, 1, mask.size());
  for (const cv::Rect& window : windows(touched, limits.longest + 1, mask.size())) {
    Flood flood(mask(window), limits);
    for (const cv::Rect& box : touched) {
      const cv::Rect part = (box & window) - window.tl();
      for (int y = part.y; y < part.br().y; ++y) {
        // Every set begins a run of cells somewhere: what lies inside the large ones is never looked at.
        const std::uint8_t *row = mask[y + window.y] + window.x, *end = row + part.br().x;
        for (const std::uint8_t* at = row + part.x; (at = find_cell(at, end, 255)) != end; at = find_cell(at, end, 0)) {
          const cv::Point seed(static_cast<int>(at - row), y);
          if (!flood.seen(seed) && flood.from(seed)) visit(flood.island(window.tl()));
        }
      }
    }
  }
}

}  // namespace modslam
