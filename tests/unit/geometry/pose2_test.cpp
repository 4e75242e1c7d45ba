// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/pose2.hpp"

#include "tests/support/matchers.hpp"

using namespace modslam;

TEST_CASE("composing a quarter turn and a step goes sideways") {
  REQUIRE_THAT(Pose2(1, 2, kPi / 2) * Pose2(1, 0, 0), IsNear({1, 3, kPi / 2}, 1e-12, 1e-12));
}

TEST_CASE("an angle is wrapped to (-pi, pi]") {
  REQUIRE(wrap_angle(kPi) == Approx(kPi));
  REQUIRE(wrap_angle(-kPi) == Approx(kPi));
  REQUIRE(wrap_angle(3 * kPi + 0.1) == Approx(-kPi + 0.1));
}

TEST_CASE("poses form a group: inverse and associativity") {
  std::mt19937_64 random(4711);
  for (int i = 0; i < 100; ++i) {
    const Pose2 A = random_pose(random, 10), B = random_pose(random, 10), C = random_pose(random, 10);
    REQUIRE_THAT(A * A.inverse(), IsNear({}, 1e-12, 1e-12));
    REQUIRE_THAT((A * B) * C, IsNear(A * (B * C), 1e-10, 1e-12));
    REQUIRE_THAT(A * between(A, B), IsNear(B, 1e-10, 1e-12));
  }
}

TEST_CASE("the Jacobians of composition agree with finite differences") {
  std::mt19937_64 random(4712);
  const double h = 1e-6;
  for (int i = 0; i < 20; ++i) {
    const Pose2 A = random_pose(random, 5), B = random_pose(random, 5);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(k);
      const Pose2 left = Pose2(A.vector() + d) * B, right = A * Pose2(B.vector() + d);
      const Eigen::Vector3d base = (A * B).vector();
      const auto slope = [&](const Pose2& moved) {
        Eigen::Vector3d change = moved.vector() - base;
        change[2] = wrap_angle(change[2]);
        return Eigen::Vector3d(change / h);
      };
      REQUIRE((slope(left) - jacobian_left(A, B).col(k)).norm() < 1e-4);
      REQUIRE((slope(right) - jacobian_right(A).col(k)).norm() < 1e-4);
    }
  }
}
