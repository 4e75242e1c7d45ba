// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <catch2/catch.hpp>

#include "common/world/ins_noise.hpp"
#include "common/world/laser_noise.hpp"
#include "common/world/odometry_noise.hpp"
#include "common/world/wheel_motion.hpp"
#include "tests/support/matchers.hpp"

namespace modslam {
namespace {

/// A drive of about 85 m round a rectangle, in pieces of `piece_m`.
double largest_error_m(const std::string& profile, std::uint64_t seed, int pieces_per_m) {
  NoisyOdometry odometry(odometry_noise(profile), seed);
  Pose2 truth;
  double largest_m = 0;
  const auto drive = [&](double distance_m, double turn_rad) {
    odometry.advance(distance_m, turn_rad);
    truth = truth * arc_motion(distance_m, turn_rad);
    largest_m = std::max(largest_m, distance(truth, odometry.T_odom_base()));
  };
  for (const int side_m : {26, 7, 26, 7, 18}) {
    for (int k = 0; k < side_m * pieces_per_m; ++k) drive(1.0 / pieces_per_m, 0);
    for (int k = 0; k < pieces_per_m; ++k) drive(0, kPi / 2 / pieces_per_m);
  }
  return largest_m;
}

double median_error_m(const std::string& profile, int pieces_per_m, std::uint64_t seeds) {
  std::vector<double> errors_m;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed)
    errors_m.push_back(largest_error_m(profile, seed, pieces_per_m));
  std::nth_element(errors_m.begin(), errors_m.begin() + static_cast<long>(seeds / 2),
                   errors_m.end());
  return errors_m[seeds / 2];
}

TEST_CASE("the same seed and stream give the same draws, every other gives others") {
  RandomStream a(7, RandomStreamId::kLaser), b(7, RandomStreamId::kLaser);
  RandomStream other_seed(8, RandomStreamId::kLaser), other_stream(7, RandomStreamId::kIns),
      other_part(7, RandomStreamId::kLaser, 1);
  const double first = a.uniform();
  CHECK(first == b.uniform());
  CHECK(first != other_seed.uniform());
  CHECK(first != other_stream.uniform());
  CHECK(first != other_part.uniform());
}

TEST_CASE("normal draws have mean 0 and variance 1") {
  RandomStream random(3, RandomStreamId::kOdometry);
  double sum = 0, squares = 0;
  constexpr int kDraws = 100000;
  for (int k = 0; k < kDraws; ++k) {
    const double draw = random.normal();
    sum += draw;
    squares += draw * draw;
  }
  CHECK(sum / kDraws == Approx(0).margin(0.015));
  CHECK(squares / kDraws == Approx(1).margin(0.02));
}

TEST_CASE("odometry without noise counts the arc that was driven") {
  NoisyOdometry odometry(odometry_noise("none"), 1);
  for (int k = 0; k < 100; ++k)
    odometry.advance(0.01 * kPi, 0.01 * kPi);  // half a circle of radius 1
  CHECK_THAT(odometry.T_odom_base(), IsNear(Pose2(0, 2, kPi), 1e-9, 1e-9));
}

TEST_CASE("odometry errs no more when its way is cut finer") {
  const double coarse_m = median_error_m("raised", 5, 400),
               fine_m = median_error_m("raised", 50, 400);
  CHECK(fine_m == Approx(coarse_m).epsilon(0.2));
}

TEST_CASE("an unknown noise is refused with the names there are") {
  CHECK_THROWS_WITH(odometry_noise("loud"), Catch::Contains("official"));
  CHECK_THROWS_WITH(NoisyIns("loud", 1), Catch::Contains("gyro"));
  CHECK_THROWS_WITH(laser_model("loud"), Catch::Contains("hokuyo-270"));
}

TEST_CASE("a gyroscope drifts while the robot stands, the one of USARSim does not") {
  NoisyIns gyro("gyro", 5), usarsim("usarsim", 5), exact("none", 5);
  for (int k = 0; k < 1200; ++k)
    for (NoisyIns* ins : {&gyro, &usarsim, &exact}) ins->advance(0, 0.05);
  CHECK(std::abs(gyro.heading_rad()) > 1e-4);
  CHECK(std::abs(gyro.heading_rad()) < 0.3);
  CHECK(usarsim.heading_rad() == 0);
  for (int k = 0; k < 100; ++k) exact.advance(0.02, 0.05);
  CHECK(exact.heading_rad() == Approx(2.0));
  CHECK(exact.yaw_rate() == Approx(0.4));
}

TEST_CASE("laser noise has the sigma it is given and loses the share it is told") {
  LaserConfig config;
  config.sigma_m = 0.02;
  config.sigma_per_m = 0.001;
  config.dropout = 0.05;
  const LaserModel model = laser_model(config.model);
  std::vector<float> ranges_m(20000, 5.0f);
  add_laser_noise(ranges_m, config, model, 1, 0);
  double squares = 0;
  int lost = 0;
  for (const float range_m : ranges_m) {
    if (range_m >= 20.0f)
      ++lost;
    else
      squares += (range_m - 5.0) * (range_m - 5.0);
  }
  CHECK(lost / 20000.0 == Approx(0.05).margin(0.006));
  CHECK(std::sqrt(squares / (20000 - lost)) == Approx(0.025).epsilon(0.03));
}

TEST_CASE("the laser noise of USARSim stays within 0.1 percent and a miss stays a miss") {
  LaserConfig config;
  config.noise = "usarsim";
  config.dropout = 0;
  std::vector<float> ranges_m(5000, 10.0f);
  ranges_m[0] = 20.0f;
  add_laser_noise(ranges_m, config, laser_model("sick"), 1, 0);
  CHECK(ranges_m[0] == 20.0f);
  const auto [low, high] = std::minmax_element(ranges_m.begin() + 1, ranges_m.end());
  CHECK(*low >= 9.9899f);
  CHECK(*low < 9.9905f);
  CHECK(*high <= 10.0101f);
  CHECK(*high > 10.0095f);
}

TEST_CASE("each sweep has noise of its own, the same whenever it is made") {
  const LaserConfig config;
  const LaserModel model = laser_model(config.model);
  std::vector<float> first(181, 5.0f), second = first, first_again = first;
  add_laser_noise(first, config, model, 1, 0);
  add_laser_noise(second, config, model, 1, 20);
  add_laser_noise(first_again, config, model, 1, 0);
  CHECK(first != second);
  CHECK(first == first_again);
}

TEST_CASE("silence of the laser means free space only where no return can be lost") {
  LaserConfig config;
  CHECK_FALSE(simulated_sensor(config).no_return_is_free);
  config.dropout = 0;
  CHECK(simulated_sensor(config).no_return_is_free);
}

}  // namespace
}  // namespace modslam
