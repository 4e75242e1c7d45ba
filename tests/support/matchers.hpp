// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <catch2/catch.hpp>
#include <random>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// REQUIRE_THAT(pose, IsNear(expected, 0.001 /*m*/, 0.001 /*rad*/))
class IsNear : public Catch::MatcherBase<Pose2> {
 public:
  IsNear(const Pose2& expected, double metres, double radians)
      : expected_(expected), metres_(metres), radians_(radians) {}
  bool match(const Pose2& pose) const override {
    return distance(pose, expected_) <= metres_ &&
           std::abs(wrap_angle(pose.heading - expected_.heading)) <= radians_;
  }
  std::string describe() const override {
    return "is within " + std::to_string(metres_) + " m and " + std::to_string(radians_) + " rad of (" +
           std::to_string(expected_.x) + ", " + std::to_string(expected_.y) + ", " +
           std::to_string(expected_.heading) + ")";
  }

 private:
  Pose2 expected_;
  double metres_, radians_;
};

/// A pose drawn evenly from [-size_m, size_m]^2 and the whole circle.
inline Pose2 random_pose(std::mt19937_64& random, double size_m) {
  std::uniform_real_distribution<double> place(-size_m, size_m), angle(-kPi, kPi);
  return {place(random), place(random), angle(random)};
}

}  // namespace modslam

template <>
struct Catch::StringMaker<modslam::Pose2> {
  static std::string convert(const modslam::Pose2& p) {
    return "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.heading) + ")";
  }
};
