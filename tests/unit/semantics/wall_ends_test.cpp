// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_ends.hpp"

#include <catch2/catch.hpp>

#include "common/semantics/layers_reader.hpp"
#include "common/semantics/semantic_files.hpp"
#include "common/semantics/semantic_mapper.hpp"
#include "tests/support/two_rooms.hpp"

using namespace modslam;

namespace {

constexpr double kCell_m = 0.05;
constexpr std::uint8_t kUnknown = 0, kFree = 1, kOccupied = 255;
const Eigen::Vector2d kEast(1, 0), kNorth(0, 1);

/// 6 x 4 m of unknown; its origin is that of the map.
struct Plate {
  Plate() { space.occupancy = cv::Mat1b(80, 120, kUnknown); }
  Plate& paint(double x0, double y0, double x1, double y1, std::uint8_t value) {
    space.occupancy(cv::Rect(cv::Point(cvRound(x0 / kCell_m), cvRound(y0 / kCell_m)), cv::Point(cvRound(x1 / kCell_m), cvRound(y1 / kCell_m)))) = value;
    return *this;
  }
  KnownSpace space{kCell_m};
};

/// A wall along y = 2.02 from x = 1 to 3, free floor north of it.
Plate wall_alone() { return Plate().paint(0.5, 2.05, 3, 3, kFree).paint(1, 2, 3, 2.05, kOccupied); }
const Eigen::Vector2d kEnd(3, 2.02);

const Wall& longest(const std::vector<Wall>& walls) {
  return *std::max_element(walls.begin(), walls.end(), [](const Wall& p, const Wall& q) { return p.length_m() < q.length_m(); });
}

}  // namespace

TEST_CASE("an end with free floor right after it is known to a cell") {
  const Plate plate = wall_alone().paint(3, 1.9, 4.5, 3, kFree);
  const WallEnd end = look_beyond(plate.space, kEnd, kEast, kNorth);
  REQUIRE(end.seen);
  REQUIRE(end.along_m >= kCell_m / std::sqrt(12.0));
  REQUIRE(end.along_m < kCell_m);
}

TEST_CASE("the farther off the first free floor after an end was seen, the less is known where the wall ends") {
  double before_m = 0;
  for (const double dark_m : {0.1, 0.2, 0.4, 0.8}) {
    const Plate plate = wall_alone().paint(3 + dark_m, 1.9, 4.5, 3, kFree);
    const WallEnd end = look_beyond(plate.space, kEnd, kEast, kNorth);
    INFO(dark_m << " m that nobody saw");
    REQUIRE(end.seen);
    REQUIRE(end.along_m > before_m);
    REQUIRE(end.along_m == Approx(dark_m / std::sqrt(3.0)).margin(0.05));
    before_m = end.along_m;
  }
}

TEST_CASE("an end that leaves the view is not known to be one, nor is one after which the wall goes on") {
  const WallEnd dark = look_beyond(wall_alone().space, kEnd, kEast, kNorth);
  REQUIRE_FALSE(dark.seen);
  REQUIRE(dark.along_m == kEndUnseen_m);
  const WallEnd longer = look_beyond(wall_alone().paint(3, 2, 6, 2.05, kOccupied).space, kEnd, kEast, kNorth);
  REQUIRE_FALSE(longer.seen);
  REQUIRE_FALSE(look_beyond(KnownSpace(kCell_m), kEnd, kEast, kNorth).seen);
}

TEST_CASE("an end at the face of another wall is known, although what is behind that one was never seen") {
  const Plate plate = wall_alone().paint(3, 2, 3.05, 3, kOccupied);
  const WallEnd end = look_beyond(plate.space, kEnd, kEast, kNorth);
  REQUIRE(end.seen);
  REQUIRE(end.along_m < 2 * kCell_m);
}

TEST_CASE("a gap inside a wall is not its end") {
  const Plate plate = wall_alone().paint(3, 1.9, 4.5, 3, kFree).paint(2.8, 2, 2.9, 2.05, kFree);
  REQUIRE(look_beyond(plate.space, kEnd, kEast, kNorth).along_m < kCell_m);
}

TEST_CASE("of a wall that leaves the laser's view the near end is known, the far one is said to be unseen") {
  // A screen that begins at x = 0 and goes on beyond what the robot sees of it.
  const SensorInfo sensor = test::short_laser();
  RandomStream random(711, RandomStreamId::kLaser);
  const test::Plan plan = {{{0, 2}, {60, 2}}, {{-5, 4}, {60, 4}}, {{-5, -2}, {60, -2}}, {{-5, -2}, {-5, 4}}};
  SemanticMapper mapper{SemanticsConfig()};
  for (int k = 0; k < 20; ++k) {
    const Pose2 place(-2 + 0.2 * k, 0.1 * (k % 3), 0);
    mapper.add_node(test::see(plan, sensor, place, &random), sensor, place);
  }
  for (int k = 0; k < 8; ++k) {
    const Pose2 place(-2.5, -1 + 0.5 * k, 0);
    mapper.add_node(test::see(plan, sensor, place, &random), sensor, place);
  }
  const SemanticLayers layers = mapper.update(true);
  const auto screen = std::find_if(layers.walls.begin(), layers.walls.end(), [](const Wall& w) { return w.length_m() > 3 && std::abs(w.a.y() - 2) < 0.1 && w.normal().y() < 0; });
  REQUIRE(screen != layers.walls.end());
  const bool from_right = screen->a.x() > screen->b.x();
  const WallEnd &near = from_right ? screen->at_b : screen->at_a, &far = from_right ? screen->at_a : screen->at_b;
  REQUIRE(near.seen);
  REQUIRE(near.along_m < 0.15);
  REQUIRE(std::abs((from_right ? screen->b : screen->a).x()) < 3 * near.along_m);
  REQUIRE_FALSE(far.seen);
  REQUIRE(far.along_m == kEndUnseen_m);
  for (const Wall& wall : layers.walls)
    for (const WallEnd& end : {wall.at_a, wall.at_b}) {
      REQUIRE(end.across_m >= kCell_m / std::sqrt(12.0) - 1e-12);
      REQUIRE(end.across_m < 0.1);
    }
  // And so it is written and read again.
  const SemanticLayers again = parse_layers(semantic_geojson(layers));
  const Wall &there = longest(layers.walls), &back = longest(again.walls);
  REQUIRE(back.at_a.seen == there.at_a.seen);
  REQUIRE(back.at_a.along_m == Approx(there.at_a.along_m).margin(1e-4));
  REQUIRE(back.at_b.across_m == Approx(there.at_b.across_m).margin(1e-4));
}

TEST_CASE("a wall seen at many points is known better across than one seen at few, and better in its middle than far out") {
  const auto across_m = [](int points, double length_m) {
    Segment s;
    s.a = {0, 0};
    s.b = {length_m, 0};
    s.points = points;
    s.sigma_m = 0.2;
    const auto bands = merge_segments({{s}, {s}}, {}, [](const Eigen::Vector2d&) { return true; });
    return bands.at(0).walls.at(0).at_b.across_m;
  };
  REQUIRE(across_m(400, 2) == Approx(0.5 * across_m(100, 2)).epsilon(0.02));
  // Twice 100 points of 0.2 / sqrt(2) across; at the end of a line its direction counts thrice: 0.141 * sqrt(4 / 200).
  REQUIRE(across_m(100, 2) == Approx(0.02).epsilon(0.1));
}

TEST_CASE("walls end where they are told to: of two rooms, most ends lie within twice what is said, nearly all within three times") {
  const SensorInfo sensor = test::short_laser();
  const test::Plan plan = test::two_rooms();
  int ends = 0, within_two = 0, within_three = 0;
  for (const double turned_rad : {0.0, 0.1, 0.37, 0.7, 1.2}) {
    RandomStream random(713, RandomStreamId::kLaser);
    const Pose2 T_map_world(0.31, -0.17, turned_rad);
    SemanticMapper mapper{SemanticsConfig()};
    for (const Pose2& place : test::drive_through_two_rooms()) mapper.add_node(test::see(plan, sensor, place, &random), sensor, T_map_world * place);
    for (const Wall& wall : mapper.update(true).walls)
      for (const auto& [p, known] : {std::pair(wall.a, wall.at_a), std::pair(wall.b, wall.at_b)}) {
        if (!known.seen) continue;
        double off_m = 1e9;  // to the nearest true end on this line, along it
        for (const test::Wall& face : plan)
          for (const Eigen::Vector2d& q : {face.a, face.b}) {
            const Eigen::Vector2d d = T_map_world * q - p;
            if (std::abs(d.dot(wall.normal())) < 0.06) off_m = std::min(off_m, std::abs(d.dot(wall.direction())));
          }
        ++ends;
        within_two += off_m < 2 * known.along_m;
        within_three += off_m < 3 * known.along_m;
      }
  }
  CAPTURE(ends, within_two, within_three);
  REQUIRE(ends > 60);
  REQUIRE(within_two > 0.8 * ends);
  REQUIRE(within_three > 0.9 * ends);
}
