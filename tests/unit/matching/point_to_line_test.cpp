// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/point_to_line.hpp"

#include <Eigen/LU>

#include "common/matching/verdict.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

std::vector<OrientedPoint> points_at(const Plan& plan, const Pose2& T_map_base, RandomStream* random = nullptr) {
  const SensorInfo sensor = short_laser();
  return orient(see(plan, sensor, T_map_base, random), sensor, {0.01, 1e-3}, 10.0, 0.03);
}

/// A submap of one scan, or of several from nearly the same place with independent noise.
struct Map {
  Map(const Plan& plan, const Pose2& T_map_base, RandomStream* random = nullptr, int scans = 1) {
    for (int k = 0; k < scans; ++k) keyframes.push_back({T_map_base, points_at(plan, T_map_base, random), {0, 0}});
    std::vector<const Keyframe*> list;
    for (const Keyframe& keyframe : keyframes) list.push_back(&keyframe);
    submap.build(list, 0.06, 1.0);
  }
  std::vector<Keyframe> keyframes;
  Submap submap;
};

}  // namespace

TEST_CASE("without noise the true pose is found from a wrong guess") {
  const Map map(furnished_room(), {});
  const Pose2 truth(0.12, -0.08, 0.05);
  const RefineResult fit = refine(points_at(furnished_room(), truth), map.submap, {}, {});
  REQUIRE(fit.converged);
  REQUIRE_THAT(fit.T_map_base, IsNear(truth, 0.004, 0.002));
  REQUIRE(fit.overlap > 0.85);
  REQUIRE(fit.normal_ratio > 0.3);
}

TEST_CASE("in a bare corridor only the way across and the heading are observed") {
  RandomStream random(51, RandomStreamId::kLaser);
  for (const double heading_rad : {0.0, 0.6, kPi / 2, -2.0}) {
    const Pose2 T_map_base(0, 0.3, heading_rad);
    const Map map(corridor(), T_map_base, &random);
    const RefineResult fit = refine(points_at(corridor(), T_map_base, &random), map.submap, T_map_base, {});
    const Observed observed = observed_information(fit);
    REQUIRE(observed.degenerate);
    REQUIRE(std::abs(std::sin(observed.degenerate_rad)) < 0.05);  // along x of the map, whatever the robot's heading
    REQUIRE(observed.information(0, 0) < 1e-3 * observed.information(1, 1));
    REQUIRE(observed.information(2, 2) > 1e4);
    REQUIRE(fit.normal_ratio < 0.05);
  }
}

TEST_CASE("in a furnished room nothing is degenerate") {
  RandomStream random(52, RandomStreamId::kLaser);
  const Map map(furnished_room(), {}, &random);
  const Observed observed = observed_information(refine(points_at(furnished_room(), {}, &random), map.submap, {}, {}));
  REQUIRE_FALSE(observed.degenerate);
  REQUIRE(observed.information.determinant() > 0);
}

TEST_CASE("the reported information is honest: NEES over 200 seeds in the room") {
  // One scan against one scan: no shared errors, so the plain information (scale 1, no model error) must
  // explain the true errors: mean of e' I e near 3.
  RefineOptions options;
  options.model_sigma_m = 0.0;
  options.robust_m = 0.3;
  double nees = 0, worst_m = 0;
  int degenerate = 0;
  constexpr int kSeeds = 200;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomStream random(5300 + seed, RandomStreamId::kLaser);
    const Pose2 T_map_ref(random.uniform(-1.5, 1), random.uniform(-0.8, 1.2), random.uniform(-kPi, kPi));
    const Pose2 truth = T_map_ref * Pose2(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.05, 0.05));
    const Map map(furnished_room(), T_map_ref, &random);
    const RefineResult fit = refine(points_at(furnished_room(), truth, &random), map.submap, T_map_ref, options);
    const Observed observed = observed_information(fit);
    degenerate += observed.degenerate;
    Eigen::Vector3d e = fit.T_map_base.vector() - truth.vector();
    e[2] = wrap_angle(e[2]);
    nees += e.dot(observed.information * e) / kSeeds;
    worst_m = std::max(worst_m, e.head<2>().norm());
  }
  std::printf("matcher in a room, 200 seeds: NEES %.2f (ideal 3), worst error %.1f mm\n", nees, 1e3 * worst_m);
  REQUIRE(degenerate == 0);
  REQUIRE(nees > 1.0);
  REQUIRE(nees < 9.0);
  REQUIRE(worst_m < 0.015);
}

TEST_CASE("a prior holds the pose in the direction that the points do not") {
  const Map map(corridor(), {});
  RefineOptions options;
  options.prior_information = Eigen::Vector3d(100, 100, 1000).asDiagonal();
  const Pose2 guess(0.4, 0.05, 0.02);  // 0.4 m along the corridor: keep it; the rest is wrong: mend it
  const RefineResult fit = refine(points_at(corridor(), {}), map.submap, guess, options);
  REQUIRE_THAT(fit.T_map_base, IsNear({0.4, 0, 0}, 0.01, 0.002));
}

TEST_CASE("no points or no map: not converged, no information, the guess stands") {
  const Map map(furnished_room(), {});
  const Pose2 guess(0.3, 0.2, 0.1);
  const RefineResult blind = refine({}, map.submap, guess, {});
  REQUIRE_FALSE(blind.converged);
  REQUIRE(blind.overlap == 0);
  REQUIRE(blind.information.norm() == 0);
  REQUIRE_THAT(blind.T_map_base, IsNear(guess, 0, 0));
  const RefineResult nowhere = refine(points_at(furnished_room(), {}), Submap(), guess, {});
  REQUIRE_FALSE(nowhere.converged);
  REQUIRE(observed_information(nowhere).information.norm() == 0);
}

TEST_CASE("a direction known worse than 3 cm is unobserved; so is, where asked for, one that hangs on a handful of points") {
  RefineResult fit;
  fit.information = Eigen::Vector3d(3'000, 500'000, 3'000'000).asDiagonal();  // 1.8 cm along, 1.4 mm across
  fit.normals_seen = fit.normals_matched = Eigen::Vector2d(10, 100).asDiagonal();
  REQUIRE_FALSE(observed_information(fit).degenerate);
  RefineResult vague = fit;
  vague.information(0, 0) = 500;  // 4.5 cm
  REQUIRE(observed_information(vague).degenerate);
  const Observed strict = observed_information(fit, 0.03, 0.02);
  REQUIRE(strict.degenerate);
  REQUIRE(std::abs(std::sin(strict.degenerate_rad)) < 1e-9);
  REQUIRE(strict.information(0, 0) == Approx(0.0).margin(1e-9));
  REQUIRE(strict.information(1, 1) == Approx(500'000));
}

TEST_CASE("a translation that few of the surfaces facing it agree on, or hardly any at all, is unobserved") {
  RefineResult fit;
  fit.information = Eigen::Vector3d(100'000, 500'000, 3'000'000).asDiagonal();
  fit.normals_seen = Eigen::Vector2d(20, 100).asDiagonal();
  fit.normals_matched = Eigen::Vector2d(15, 90).asDiagonal();
  REQUIRE_FALSE(observed_information(fit).degenerate);
  fit.normals_matched(0, 0) = 8;  // niches of another corridor: 8 of 20 fit by chance
  const Observed chance = observed_information(fit);
  REQUIRE(chance.degenerate);
  REQUIRE(chance.information(0, 0) == Approx(0.0).margin(1e-9));
  REQUIRE(chance.information(1, 1) == Approx(500'000));
  fit.normals_seen(0, 0) = fit.normals_matched(0, 0) = 4;  // all of four points
  REQUIRE(observed_information(fit).degenerate);
}
