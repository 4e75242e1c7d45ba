// SPDX-License-Identifier: BSD-3-Clause
#include <catch2/catch.hpp>
#include <limits>

#include "common/formats/file_bytes.hpp"
#include "common/places/place_mapper.hpp"
#include "common/places/place_smoother.hpp"
#include "common/places/scan_features.hpp"
#include "tests/support/two_rooms.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

/// A scan of `beams` beams over `field_rad`, looking ahead.
Scan look(const Plan& plan, const Pose2& T_map_base, int beams, double field_rad, double reach_m) {
  Scan scan;
  scan.rad0 = -field_rad / 2;
  scan.radstep = field_rad / (beams - 1);
  for (int k = 0; k < beams; ++k)
    scan.ranges_m.push_back(static_cast<float>(
        cast_ray(plan, T_map_base.translation(), T_map_base.heading + scan.bearing_rad(static_cast<std::size_t>(k)), reach_m)));
  return scan;
}

SensorInfo reaching(double reach_m) {
  SensorInfo sensor;
  sensor.range_max_m = reach_m;
  return sensor;
}

std::vector<float> features_of(const Plan& plan, const Pose2& T_map_base, int beams) {
  return place_features(PanoramaMaker().add(look(plan, T_map_base, beams, 2 * kPi * (beams - 1) / beams, 30), reaching(30), T_map_base));
}

PlaceModel shipped_model() { return PlaceModel::parse(read_file_bytes(MODSLAM_SOURCE_DIR "/config/places.yml").bytes); }

PlaceKind likeliest(const PlaceConfidence& p) { return static_cast<PlaceKind>(std::max_element(p.begin(), p.end()) - p.begin()); }

bool all_finite(const std::vector<float>& features) {
  return std::all_of(features.begin(), features.end(), [](float v) { return std::isfinite(v); });
}

/// Straight down a corridor 2 m wide and into a room of 8 x 6 m at its end, through a door of 0.9 m.
Plan corridor_and_room() {
  Plan plan;
  plan.push_back({{-20, -1}, {0, -1}});
  plan.push_back({{-20, 1}, {0, 1}});
  plan.push_back({{-20, -1}, {-20, 1}});
  for (const double x : {0.0, 0.12}) {
    plan.push_back({{x, -3}, {x, -0.45}});
    plan.push_back({{x, 0.45}, {x, 3}});
  }
  plan.push_back({{0, -0.45}, {0.12, -0.45}});
  plan.push_back({{0, 0.45}, {0.12, 0.45}});
  plan.push_back({{0.12, -3}, {8, -3}});
  plan.push_back({{8, -3}, {8, 3}});
  plan.push_back({{8, 3}, {0.12, 3}});
  return plan;
}

}  // namespace

TEST_CASE("what a place looks like does not change with the count of beams") {
  const std::vector<float> coarse = features_of(furnished_room(), {1, 0.4, 0.3}, 360), fine = features_of(furnished_room(), {1, 0.4, 0.3}, 1440);
  REQUIRE(coarse.size() == fine.size());
  REQUIRE(coarse.size() > 50);
  for (std::size_t k = 0; k < 10; ++k) REQUIRE(coarse[k] == Approx(fine[k]).epsilon(0.03).margin(0.03));
}

TEST_CASE("what a place looks like does not change when the robot turns on the spot") {
  const std::vector<float> before = features_of(furnished_room(), {1, 0.4, 0}, 720), after = features_of(furnished_room(), {1, 0.4, 120 * kPi / 180}, 720);
  for (std::size_t k = 0; k < 10; ++k) REQUIRE(before[k] == Approx(after[k]).epsilon(0.03).margin(0.03));
}

TEST_CASE("a laser that looks ahead knows from the scans before what is behind it") {
  const Plan plan = corridor_and_room();
  PanoramaMaker maker;
  Panorama view;
  for (double x = -8; x <= -2; x += 0.3) view = maker.add(look(plan, {x, 0, 0}, 181, kPi, 20), reaching(20), {x, 0, 0});
  REQUIRE(view.known > 0.75);
  REQUIRE(view.range_m[135] == Approx(std::sqrt(2.0)).margin(0.15));  // back left: the wall of the corridor
  REQUIRE(view.range_m[90] == Approx(1.0).margin(0.05));
}

TEST_CASE("nothing measured is no place, and no scan breaks the panorama") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  Scan empty, one, broken, twice;
  one.ranges_m = {2.0f};
  broken.ranges_m = std::vector<float>(181, nan);
  broken.radstep = 0.01;
  twice.ranges_m = {nan, infinity, -1, 0, 3};
  twice.radstep = -1.5;  // turns the other way, and more than once around
  PanoramaMaker maker;
  for (const Scan& scan : {empty, one, broken, twice, empty}) {
    const Panorama view = maker.add(scan, reaching(20), {});
    REQUIRE(view.known >= 0);
    REQUIRE(view.known <= 1);
    for (const float range_m : view.range_m) REQUIRE((range_m >= 0 && range_m <= static_cast<float>(kPanoramaReach_m)));
    REQUIRE(all_finite(place_features(view)));
  }
  REQUIRE(PanoramaMaker().add(empty, reaching(20), {}).known == 0);
  for (const double p : shipped_model().confidence(PanoramaMaker().add(empty, reaching(20), {}))) REQUIRE(p == Approx(1.0 / 3));
}

TEST_CASE("the shipped classifiers tell corridor, doorway and room apart along a drive that they never saw, whatever the laser") {
  const Plan plan = corridor_and_room();
  for (const auto& [beams, field_rad, reach_m] : {std::tuple{181, kPi, 20.0}, {228, 240 * kPi / 180, 4.0}, {1081, 1.5 * kPi, 30.0}}) {
    PlaceMapper mapper(shipped_model());
    std::vector<double> xs;
    for (double x = -14; x < 5; x += 0.3) {
      mapper.add_node(look(plan, {x, 0, 0}, beams, field_rad, reach_m), reaching(reach_m), {x, 0, 0});
      xs.push_back(x);
    }
    const std::vector<Place> places = mapper.places({});
    REQUIRE(places.size() == xs.size());
    int right = 0, doorways = 0;
    for (std::size_t k = 0; k < xs.size(); ++k) {
      const PlaceKind truth = std::abs(xs[k] - 0.06) < 0.4 ? PlaceKind::kDoorway : xs[k] < 0 ? PlaceKind::kCorridor : PlaceKind::kRoom;
      right += places[k].kind == truth;
      doorways += places[k].kind == PlaceKind::kDoorway;
      REQUIRE(places[k].node == static_cast<std::int64_t>(k));
      REQUIRE(places[k].confidence > 1.0 / 3 - 1e-9);
    }
    CAPTURE(beams);
    REQUIRE(right >= 0.85 * static_cast<double>(xs.size()));
    REQUIRE(doorways >= 1);
  }
}

TEST_CASE("a trained model comes back from its text, and other text is refused") {
  std::vector<PlacePath> paths(1);
  RandomStream random(811, RandomStreamId::kLaser);
  for (int k = 0; k < 60; ++k) {
    const double y = random.uniform(-0.8, 0.8);
    paths[0].push_back({features_of(corridor(), {random.uniform(-5, 5), y, 0}, 360), PlaceKind::kCorridor, {}});
    paths[0].push_back({features_of(furnished_room(), {random.uniform(-2, 1), y, 0}, 360), PlaceKind::kRoom, {}});
    paths[0].push_back({features_of(two_rooms(), {random.uniform(-0.2, 0.2), 0.2 * y, 0}, 360), PlaceKind::kDoorway, {}});
  }
  const PlaceModel model = PlaceModel::train(paths), twin = PlaceModel::parse(model.text());
  for (const PlaceSample& sample : paths[0]) {
    REQUIRE(likeliest(model.confidence(sample.features)) == sample.kind);
    REQUIRE(model.confidence(sample.features)[0] == Approx(twin.confidence(sample.features)[0]).margin(1e-6));
  }
  REQUIRE(twin.transitions()[0][1] == Approx(model.transitions()[0][1]));
  for (const char* text : {"", "no yaml: [", "%YAML:1.0\n---\nfeatures: 3\n"}) REQUIRE_THROWS_AS(PlaceModel::parse(text), std::runtime_error);
  for (PlaceSample& sample : paths[0]) sample.kind = PlaceKind::kRoom;
  REQUIRE_THROWS_AS(PlaceModel::train(paths), std::invalid_argument);
}

TEST_CASE("what the map says of places is weighed as it was learned") {
  std::vector<PlacePath> paths(1);
  for (int k = 0; k < 60; ++k) {
    const PlaceOnMap door{k % 10 ? PlaceHint::kNone : PlaceHint::kAtDoor, -1};  // doors are found where there are none as often as not
    const PlaceOnMap inside{k % 5 ? PlaceHint::kInCorridor : PlaceHint::kInRoom, 3};
    paths[0].push_back({features_of(corridor(), {0.1 * k, 0, 0}, 360), PlaceKind::kCorridor, inside});
    paths[0].push_back({features_of(furnished_room(), {-0.02 * k, 0, 0}, 360), PlaceKind::kRoom, door});
    paths[0].push_back({features_of(two_rooms(), {0, 0.004 * k, 0}, 360), PlaceKind::kDoorway, door});
  }
  const PlaceModel model = PlaceModel::parse(PlaceModel::train(paths).text());
  const PlaceConfidence &at_door = model.likelihood(PlaceHint::kAtDoor), &in_corridor = model.likelihood(PlaceHint::kInCorridor);
  CHECK(at_door[0] == Approx(at_door[2]));
  CHECK(at_door[1] < 0.5 * at_door[0]);
  CHECK(in_corridor[1] > 5 * in_corridor[0]);
  for (std::size_t kind = 0; kind < kPlaceKinds; ++kind) {
    double sum = 0;
    for (const PlaceHint hint : {PlaceHint::kNone, PlaceHint::kInRoom, PlaceHint::kInCorridor, PlaceHint::kAtDoor}) {
      CHECK(model.likelihood(hint)[kind] > 0);  // no hint rules a kind out
      sum += model.likelihood(hint)[kind];
    }
    CHECK(sum == Approx(1));
  }
}

TEST_CASE("a room is one kind of place: what is seen from most of its nodes decides for those that see it differently") {
  const PlaceModel model = shipped_model();
  const PlaceTransitions any = {{{0.34, 0.33, 0.33}, {0.33, 0.34, 0.33}, {0.33, 0.33, 0.34}}};
  std::vector<PlaceConfidence> seen(30, {0.04, 0.94, 0.02});
  std::vector<PlaceOnMap> on_map(30, {PlaceHint::kInRoom, 5});
  for (std::size_t k = 0; k < 30; k += 5) seen[k] = {0.6, 0.38, 0.02};  // a widening
  seen.push_back({0.02, 0.03, 0.95});                                    // its doorway
  on_map.push_back({PlaceHint::kAtDoor, 5});
  seen.push_back({0.6, 0.38, 0.02});                                     // another room
  on_map.push_back({PlaceHint::kInRoom, 6});
  const auto alone = smooth_places(seen, any, {}), told = smooth_places(seen, any, told_by_map(seen, on_map, model));
  CHECK(likeliest(alone[10]) == PlaceKind::kRoom);
  CHECK(likeliest(told[10]) == PlaceKind::kCorridor);
  CHECK(likeliest(told[11]) == PlaceKind::kCorridor);
  CHECK(likeliest(told[30]) == PlaceKind::kDoorway);
  CHECK(likeliest(told[31]) == PlaceKind::kRoom);
  CHECK(told_by_map(seen, {}, model).empty());
  CHECK(told_by_map({}, on_map, model).empty());
}

TEST_CASE("one strange scan does not change what a place is, and lasting ones do") {
  const PlaceTransitions stay = {{{0.96, 0.02, 0.02}, {0.02, 0.96, 0.02}, {0.1, 0.1, 0.8}}};
  std::vector<PlaceConfidence> seen(21, {0.8, 0.1, 0.1});
  seen[10] = {0.2, 0.7, 0.1};
  REQUIRE(likeliest(smooth_places(seen, stay, {})[10]) == PlaceKind::kRoom);
  for (std::size_t k = 8; k < 15; ++k) seen[k] = {0.05, 0.9, 0.05};
  REQUIRE(likeliest(smooth_places(seen, stay, {})[11]) == PlaceKind::kCorridor);
  REQUIRE(likeliest(smooth_places(seen, stay, {})[20]) == PlaceKind::kRoom);
  REQUIRE(smooth_places({}, stay, {}).empty());
}

TEST_CASE("a hundred thousand nodes are smoothed without a number getting lost") {
  const PlaceTransitions stay = {{{0.98, 0.01, 0.01}, {0.01, 0.98, 0.01}, {0.2, 0.2, 0.6}}};
  RandomStream random(812, RandomStreamId::kLaser);
  std::vector<PlaceConfidence> seen;
  for (int k = 0; k < 100'000; ++k) {
    const double p = k % 7 ? random.uniform() : 0.0;
    seen.push_back({p, 1 - p, 0});
  }
  for (const PlaceConfidence& p : smooth_places(seen, stay, {})) REQUIRE(std::abs(p[0] + p[1] + p[2] - 1) < 1e-9);
}

TEST_CASE("without a model there are no places") {
  PlaceMapper mapper(std::nullopt);
  mapper.add_node({}, {}, {});
  REQUIRE(mapper.places({}).empty());
}
