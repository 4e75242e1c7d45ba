// SPDX-License-Identifier: BSD-3-Clause
/// Boxes of cells.
#include "common/semantics/boxes.hpp"

#include <catch2/catch.hpp>

#include "common/world/random.hpp"

using namespace modslam;

TEST_CASE("the box around what is set, or differs, holds all of it and nothing that it could do without") {
  RandomStream random(911, RandomStreamId::kLaser);
  const auto below = [&](int n) { return static_cast<int>(random.uniform(0, n - 1e-9)); };
  for (int round = 0; round < 20000; ++round) {
    cv::Mat1b mask(1 + below(6), 1 + below(20), std::uint8_t{0});
    cv::Mat1i before(mask.size(), 7), after = before.clone();
    cv::Rect box;
    for (int k = below(5); k > 0; --k) {
      const cv::Point c(below(mask.cols), below(mask.rows));
      mask(c) = 255;
      after(c) = 8 + below(1000);
      box |= cv::Rect(c, cv::Size(1, 1));
    }
    REQUIRE(box_of_set(mask) == box);
    REQUIRE(difference(before, after) == box);
  }
}
