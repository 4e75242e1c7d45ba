// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/chamfer.hpp"

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

#include "common/world/random.hpp"

using namespace modslam;

namespace {

cv::Mat1b random_mask(RandomStream& random) {
  const auto upto = [&](int most) { return static_cast<int>(random.uniform(0, most)); };
  cv::Mat1b mask(1 + upto(90), 1 + upto(90), std::uint8_t{0});
  for (int k = 0; k < 12; ++k)
    cv::rectangle(mask, {upto(90), upto(90)}, {upto(90), upto(90)}, cv::Scalar(k % 3 ? 255 : 0), cv::FILLED);
  mask(0, 0) = 0;  // somewhere is a cell that is not set
  return mask;
}

}  // namespace

TEST_CASE("distances in a mask are OpenCV's to the bit") {
  RandomStream random(911, RandomStreamId::kLaser);
  for (int k = 0; k < 200; ++k) {
    const cv::Mat1b mask = random_mask(random);
    cv::Mat1f theirs;
    cv::distanceTransform(mask, theirs, cv::DIST_L2, 5);
    REQUIRE(cv::norm(distances(mask, 40), cv::min(theirs, 40.0F), cv::NORM_INF) == 0);
    cv::Mat1b padded;
    cv::copyMakeBorder(mask, padded, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);
    cv::distanceTransform(padded, theirs, cv::DIST_L2, 3);
    double most = 0;
    cv::minMaxLoc(theirs, nullptr, &most);
    REQUIRE(deepest(mask) == most);
  }
}

TEST_CASE("where all is set and nothing ends it, every distance is the most") {
  const cv::Mat1b mask(7, 13, std::uint8_t{255});
  REQUIRE(cv::norm(distances(mask, 40) - 40.0F, cv::NORM_INF) == 0);
}
