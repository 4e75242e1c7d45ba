// SPDX-License-Identifier: BSD-3-Clause
#include "common/loops/relocalizer.hpp"

#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A lost robot drives straight on, in a tracking frame of its own.
struct Lost {
  Relocalizer::Answer drive(const Plan& plan, Pose2 T_map_base, int steps) {
    Relocalizer::Answer answer;
    for (int k = 0; k < steps && answer.verdict != Verdict::kOk; ++k) {
      answer = map.look(see(plan, sensor, T_map_base, &random), sensor, T_track_map * T_map_base);
      truth = T_map_base;
      T_map_base = T_map_base * Pose2(0.45, 0, 0.35);  // a circle of 1.3 m
    }
    return answer;
  }

  SensorInfo sensor = short_laser();
  RandomStream random{7, RandomStreamId::kLaser};
  Relocalizer map{0.01, 10.0};
  Pose2 T_track_map{17, -40, 2.5}, truth;
};

void map_circle(Lost& lost, const Plan& plan, const Pose2& centre) {
  for (int k = 0; k < 20; ++k) {
    const double angle = 2 * kPi * k / 20;
    const Pose2 T = centre * Pose2(1.2 * std::cos(angle), 1.2 * std::sin(angle), angle + 1.57);
    lost.map.add_node(k, T, see(plan, lost.sensor, T), lost.sensor);
  }
}

}  // namespace

TEST_CASE("a robot that knows nothing is placed in a furnished room once it has driven a few metres") {
  Lost lost;
  map_circle(lost, furnished_room(), {});
  const auto answer = lost.drive(furnished_room(), {0.4, -1.3, -0.4}, 25);
  REQUIRE(answer.verdict == Verdict::kOk);
  REQUIRE_THAT(answer.T_map_base, IsNear(lost.truth, 0.05, 0.02));
  REQUIRE(answer.posterior > 0.99);
  REQUIRE(answer.nearest >= 0);
  REQUIRE(answer.scans >= 6);
}

TEST_CASE("in an empty box, which looks the same from two sides, no place is named however long the robot drives") {
  Plan box;
  add_box(box, -3, -2, 3, 2);
  Lost lost;
  map_circle(lost, box, {});
  const auto answer = lost.drive(box, {0.4, -1.2, -0.4}, 40);
  REQUIRE(answer.verdict == Verdict::kAmbiguous);
  REQUIRE(answer.hypotheses >= 2);
}

TEST_CASE("a robot in another building is not placed") {
  Lost lost;
  map_circle(lost, furnished_room(), {});
  Plan other;
  add_box(other, -9, -1.5, 9, 1.5);
  add_box(other, -2, 1.0, -1.5, 1.5);
  const auto answer = lost.drive(other, {-3, 0, 0.1}, 12);
  REQUIRE(answer.verdict != Verdict::kOk);
}

TEST_CASE("what was seen before a jump of the tracking is forgotten on request, and a map without walls answers") {
  Lost lost;
  map_circle(lost, furnished_room(), {});
  lost.drive(furnished_room(), {0.4, -1.3, -0.4}, 4);
  lost.map.forget();
  const auto first = lost.map.look(see(furnished_room(), lost.sensor, {0, 0, 0}), lost.sensor, {});
  REQUIRE(first.scans == 1);
  Relocalizer empty(0.01, 10.0);
  REQUIRE(empty.look(see(furnished_room(), lost.sensor, {0, 0, 0}), lost.sensor, {}).verdict == Verdict::kFailed);
  REQUIRE_THROWS_AS(empty.add_node(0, {}, see(furnished_room(), lost.sensor, {0, 0, 0}), lost.sensor), std::logic_error);
}

TEST_CASE("near a guess one scan says where exactly, and that the guess was hopeless") {
  Lost lost;
  map_circle(lost, furnished_room(), {});
  const Pose2 truth(0.8, 0.7, 1.1);
  const Scan scan = see(furnished_room(), lost.sensor, truth, &lost.random);
  const auto near = lost.map.locate(scan, lost.sensor, truth * Pose2(0.08, -0.06, 0.05));
  REQUIRE(near.verdict == Verdict::kOk);
  REQUIRE_THAT(near.T_map_base, IsNear(truth, 0.02, 0.01));
  REQUIRE_FALSE(is_usable(lost.map.locate(scan, lost.sensor, truth * Pose2(1.5, 1.0, 2.0)).verdict));
}
