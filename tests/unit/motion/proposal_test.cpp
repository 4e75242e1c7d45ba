// SPDX-License-Identifier: BSD-3-Clause
#include "common/motion/proposal.hpp"

#include <Eigen/LU>

#include "common/motion/odometry_model.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

TEST_CASE("two equally sure sensors meet in the middle, a surer one draws nearer") {
  const Eigen::Matrix3d sure = 1e4 * Eigen::Matrix3d::Identity();
  REQUIRE_THAT(fuse({{{1.0, 0, 0.1}, sure}, {{1.2, 0, 0.3}, sure}}).T_from_to, IsNear({1.1, 0, 0.2}, 1e-5, 1e-5));
  REQUIRE_THAT(fuse({{{1.0, 0, 0}, 3 * sure}, {{1.2, 0, 0}, sure}}).T_from_to, IsNear({1.05, 0, 0}, 1e-5, 1e-5));
}

TEST_CASE("headings across pi are averaged the short way") {
  const Eigen::Matrix3d sure = 1e4 * Eigen::Matrix3d::Identity();
  REQUIRE_THAT(fuse({{{0, 0, kPi - 0.1}, sure}, {{0, 0, -kPi + 0.1}, sure}}).T_from_to, IsNear({0, 0, kPi}, 1e-9, 1e-5));
}

TEST_CASE("each direction comes from whoever saw it") {
  const Eigen::Matrix3d across = Eigen::Vector3d(0, 1e6, 1e6).asDiagonal(), odometry = 100 * Eigen::Matrix3d::Identity();
  const Proposal proposal = fuse({{{9, 0.02, 0.01}, across}, {{0.3, 0.5, 0.4}, odometry}});
  REQUIRE_THAT(proposal.T_from_to, IsNear({0.3, 0.02, 0.01}, 1e-3, 1e-3));
  REQUIRE(proposal.covariance(0, 0) == Approx(0.01).epsilon(0.01));
  REQUIRE(proposal.covariance(1, 1) == Approx(1e-6).epsilon(0.01));
}

TEST_CASE("what nobody saw is said to be unknown, not surely zero") {
  REQUIRE(fuse({{{1, 0, 0}, Eigen::Matrix3d::Zero()}}).covariance(0, 0) == Approx(100));
}

TEST_CASE("draws scatter with the covariance they are drawn from") {
  Proposal proposal;
  proposal.T_from_to = {1, 2, 0.5};
  proposal.covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  std::mt19937_64 random(121);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 20000;
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::Vector3d d = sample(proposal, random).vector() - proposal.T_from_to.vector();
    mean += d / kDraws;
    cov += d * d.transpose() / kDraws;
  }
  REQUIRE(mean.norm() < 0.01);
  REQUIRE((cov - proposal.covariance).norm() < 0.05 * proposal.covariance.norm());
}

TEST_CASE("odometry is trusted less the farther it went, and never perfectly") {
  const OdometryModelConfig model;
  const Eigen::Matrix3d still = odometry_covariance({}, model), metre = odometry_covariance({1, 0, 0}, model),
                        turn = odometry_covariance({0, 0, 1}, model);
  REQUIRE(still(0, 0) > 0);
  REQUIRE(std::sqrt(metre(0, 0)) == Approx(model.sigma_m + model.sigma_per_m));
  REQUIRE(std::sqrt(turn(2, 2)) == Approx(model.sigma_rad + model.sigma_rad_per_rad));
  REQUIRE(turn(0, 0) == Approx(still(0, 0)));
  REQUIRE(ins_information(0.5, model).topLeftCorner(2, 2).norm() == 0);
  REQUIRE(ins_information(0.5, model)(2, 2) > ins_information(1.0, model)(2, 2));
}

TEST_CASE("of a systematic source only the directions count that the other knows less of") {
  const Eigen::Matrix3d odometry = Eigen::Vector3d(100, 100, 400).asDiagonal();
  const Eigen::Matrix3d laser = Eigen::Vector3d(1e6, 0, 1e6).asDiagonal();
  const Eigen::Matrix3d kept = information_where_better(odometry, laser);
  REQUIRE((kept - Eigen::Matrix3d(Eigen::Vector3d(0, 100, 0).asDiagonal())).norm() < 1e-9);
  REQUIRE((information_where_better(odometry, Eigen::Matrix3d::Zero()) - odometry).norm() < 1e-9);
  REQUIRE(information_where_better(odometry, 2 * odometry).norm() < 1e-9);
}

TEST_CASE("a corridor's blind direction stays odometry's, however it lies to the robot") {
  const Eigen::Vector3d blind = Eigen::Vector3d(std::cos(0.7), std::sin(0.7), 0);
  const Eigen::Matrix3d odometry = Eigen::Vector3d(100, 100, 400).asDiagonal();
  const Eigen::Matrix3d laser = 1e6 * (Eigen::Matrix3d::Identity() - blind * blind.transpose());
  const Eigen::Matrix3d kept = information_where_better(odometry, laser), sum = kept + laser;
  REQUIRE(1 / blind.dot(sum.inverse() * blind) == Approx(100).epsilon(0.01));
}
