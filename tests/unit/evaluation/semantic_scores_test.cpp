// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/semantic_scores.hpp"

#include <algorithm>
#include <numeric>

#include "common/evaluation/assignment.hpp"
#include "common/evaluation/score_json.hpp"
#include "tests/support/matchers.hpp"

using namespace modslam;

namespace {

MapPolygon box(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}};
}

/// Two rooms of 4 x 4 m side by side, a door of 1 m between them at (4, 2).
SemanticMap two_rooms() {
  SemanticMap map;
  map.walls = {{{0, 0}, {8, 0}}, {{8, 0}, {8, 4}},   {{8, 4}, {0, 4}},
               {{0, 4}, {0, 0}}, {{4, 0}, {4, 1.5}}, {{4, 2.5}, {4, 4}}};
  map.rooms = {{"west", box(0, 0, 4, 4)}, {"east", box(4, 0, 8, 4)}};
  map.doors = {{"d", {4, 1.5}, {4, 2.5}, false, true, "west", "east"}};
  return map;
}

SemanticScores score(const SemanticMap& found, const SemanticMap& truth) {
  return score_semantics(found, truth, everything_visible(truth));
}

/// A sweep of 360 beams in the west room: exact ranges to the walls of two_rooms().
PlacedScan scan_from(const Eigen::Vector2d& place) {
  PlacedScan placed;
  placed.T_world_laser = Pose2(place.x(), place.y(), 0);
  placed.sensor.range_max_m = 20;
  placed.scan.radstep = 2 * kPi / 1440;
  for (int i = 0; i < 1440; ++i) {
    const double a = placed.scan.bearing_rad(static_cast<std::size_t>(i));
    const Eigen::Vector2d u(std::cos(a), std::sin(a));
    double range_m = 100;
    for (const MapWall& w : two_rooms().walls) {
      const Eigen::Vector2d v = w.b - w.a, d = w.a - place;
      const double det = u.x() * -v.y() + v.x() * u.y();
      if (std::abs(det) < 1e-12) continue;
      const double t = (d.x() * -v.y() + v.x() * d.y()) / det,
                   s = (u.x() * d.y() - u.y() * d.x()) / det;
      if (t > 0 && s >= 0 && s <= 1) range_m = std::min(range_m, t);
    }
    placed.scan.ranges_m.push_back(static_cast<float>(range_m));
  }
  return placed;
}

}  // namespace

TEST_CASE("A perfect map scores one everywhere", "[evaluation]") {
  const SemanticScores s = score(two_rooms(), two_rooms());
  for (const WallScore& w : s.walls.at) CHECK(w.by_length.f1() == Approx(1));
  CHECK(s.walls.truth_m == Approx(27));
  CHECK(s.rooms.at_half.f1() == Approx(1));
  CHECK(s.rooms.mean_iou == Approx(1));
  CHECK(s.doors.strict.f1() == Approx(1));
  CHECK(s.doors.pairs_right == 1);
}

TEST_CASE("A perfect map in another frame scores one once it is aligned", "[evaluation]") {
  const Pose2 T(10, -3, 2.0);
  const SemanticScores s =
      score(transformed(T, transformed(T.inverse(), two_rooms())), two_rooms());
  CHECK(s.walls.at[0].by_length.f1() == Approx(1));
  CHECK(s.rooms.mean_iou == Approx(1));
}

TEST_CASE("Walls shifted by 7 cm count at 10 cm but not at 5 cm", "[evaluation]") {
  SemanticMap found, truth;
  truth.walls = {{{0, 0}, {10, 0}}};
  found.walls = {{{0, 0.07}, {10, 0.07}}};
  const WallScores s = score(found, truth).walls;
  CHECK(s.at[0].by_length.precision == 0);
  CHECK(s.at[1].by_length.precision == Approx(1));
  CHECK(s.at[1].by_length.recall == Approx(1));
  CHECK(s.median_error_m == Approx(0.07));
}

TEST_CASE("Half a wall has half the recall; a wall across has no precision", "[evaluation]") {
  SemanticMap found, truth;
  truth.walls = {{{0, 0}, {10, 0}}};
  found.walls = {{{0, 0}, {5, 0}}};
  CHECK(score(found, truth).walls.at[0].by_length.recall == Approx(0.5).margin(0.01));
  CHECK(score(found, truth).walls.at[0].by_length.precision == Approx(1));
  found.walls = {{{5, -1}, {5, 1}}};
  CHECK(score(found, truth).walls.at[2].by_length.precision == 0);
}

TEST_CASE("A thick wall is found at its faces, and either face recalls it", "[evaluation]") {
  SemanticMap found, truth;
  truth.walls = {{{0, 0}, {10, 0}, 0.3}};
  found.walls = {{{0, 0.15}, {10, 0.15}}};
  CHECK(score(found, truth).walls.at[0].by_length.f1() == Approx(1));
  found.walls = {{{0, 0}, {10, 0}}};
  CHECK(score(found, truth).walls.at[1].by_length.f1() == 0);
}

TEST_CASE("Rooms that were merged match one true room at most", "[evaluation]") {
  SemanticMap found = two_rooms();
  found.rooms = {{"1", box(0, 0, 8, 4)}};
  const RoomScores s = score(found, two_rooms()).rooms;
  CHECK(s.matched == 1);  // IoU is exactly one half
  CHECK(s.at_half.recall == Approx(0.5));
  CHECK(s.mean_iou == Approx(0.25));
  found.rooms = {{"1", box(0, 0, 8.1, 4)}};
  CHECK(score(found, two_rooms()).rooms.matched == 0);
}

TEST_CASE("A ring-shaped corridor is its ring, and an outline that crosses itself is repaired",
          "[evaluation]") {
  MapPolygon ring = box(0, 0, 10, 10);
  ring.holes = {box(2, 2, 8, 8).outline};
  CHECK(area_m2(ring) == Approx(64));
  CHECK(overlap_m2(ring, box(0, 0, 5, 5)) == Approx(16));
  CHECK(contains(ring, {1, 1}));
  CHECK_FALSE(contains(ring, {5, 5}));
  CHECK(area_m2({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, {}}) == Approx(2));
  CHECK(area_m2({{{0, 0}, {1, 0}, {2, 0}}, {}}) == 0);
}

TEST_CASE("Doors match one to one within half a metre and name their rooms", "[evaluation]") {
  SemanticMap found = two_rooms();
  found.rooms[0].id = "7";
  found.rooms[1].id = "8";
  found.doors = {{"1", {4.1, 2.6}, {4.1, 1.7}, false, true, "8", "7"},
                 {"2", {4.2, 1.5}, {4.2, 2.5}, false, true, "7", "7"}};
  const DoorScores s = score(found, two_rooms()).doors;
  CHECK(s.matched == 1);
  CHECK(s.at_half_metre.precision == Approx(0.5));
  CHECK(s.at_half_metre.recall == Approx(1));
  CHECK(s.pairs_right == 1);
  CHECK(s.median_width_error_m == Approx(0.1));
  found.doors = {{"1", {4, 2.1}, {4, 3.1}, false, false, "", ""}};
  CHECK(score(found, two_rooms()).doors.matched == 0);
}

TEST_CASE("What no beam has touched is not missed, and what it invents there is counted apart",
          "[evaluation]") {
  // From the far corner of the west room nothing is seen of the east room but a wedge through the
  // door.
  const Visibility v =
      visible_in(two_rooms(), {scan_from({1, 2}), scan_from({1, 1}), scan_from({1, 3})});
  CHECK(v.rooms_explored[0] > 0.95);
  CHECK(v.rooms_explored[1] < 0.9);
  CHECK(v.doors[0]);
  SemanticMap found = two_rooms();
  found.rooms = {found.rooms[0], {"3", box(20, 20, 25, 25)}};
  const SemanticScores s = score_semantics(found, two_rooms(), v);
  CHECK(s.rooms.explored_truth == 1);
  CHECK(s.rooms.at_half.recall == Approx(1));
  CHECK(s.rooms.false_in_unseen == 1);
  CHECK(s.rooms.at_half.precision == Approx(1));
  // By hand: 15 m of the west room, all 4 m of the east wall and 1 m each of the walls beside it.
  CHECK(s.walls.visible_m == Approx(21).margin(0.6));
  CHECK(s.walls.at[0].by_length.recall == Approx(1));
}

TEST_CASE("Without any beam nothing can be recalled and nothing divides by zero", "[evaluation]") {
  const SemanticScores s = score_semantics(two_rooms(), two_rooms(), visible_in(two_rooms(), {}));
  CHECK(s.walls.visible_m == 0);
  CHECK(s.walls.at[0].by_length.recall == 0);
  CHECK(s.doors.visible_truth == 0);
  const SemanticScores nothing = score({}, {});
  CHECK(nothing.rooms.at_half.f1() == 0);
  CHECK(score({}, two_rooms()).doors.at_half_metre.recall == 0);
  CHECK(score(two_rooms(), {}).rooms.at_half.precision == 0);
  CHECK_FALSE(to_table(nothing).empty());
  CHECK(to_json(nothing).contains("walls"));
}

TEST_CASE("The assignment is as cheap as the best of all permutations", "[evaluation]") {
  std::mt19937_64 random(11);
  for (int round = 0; round < 200; ++round) {
    const int rows = 1 + static_cast<int>(random() % 5),
              columns = 1 + static_cast<int>(random() % 5);
    Eigen::MatrixXd cost(rows, columns);
    for (int i = 0; i < cost.size(); ++i) cost(i) = static_cast<double>(random() % 100) - 50;
    const std::vector<int> column_of = assign(cost);
    double total = 0;
    std::vector<int> used;
    for (int r = 0; r < rows; ++r)
      if (column_of[r] >= 0) total += cost(r, column_of[r]), used.push_back(column_of[r]);
    std::sort(used.begin(), used.end());
    REQUIRE(std::unique(used.begin(), used.end()) == used.end());
    REQUIRE(static_cast<int>(used.size()) == std::min(rows, columns));
    const bool wide = rows <= columns;
    std::vector<int> order(static_cast<std::size_t>(std::max(rows, columns)));
    std::iota(order.begin(), order.end(), 0);
    double best = 1e9;
    do {
      double sum = 0;
      for (int i = 0; i < std::min(rows, columns); ++i)
        sum += wide ? cost(i, order[i]) : cost(order[i], i);
      best = std::min(best, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    REQUIRE(total == Approx(best));
  }
  CHECK(assign(Eigen::MatrixXd(0, 3)).empty());
  CHECK(assign(Eigen::MatrixXd(2, 0)) == std::vector<int>{-1, -1});
}

TEST_CASE("an object is right where a true one lies under it, its class when the true one is that or a kind of it") {
  SemanticMap truth = two_rooms(), found = truth;
  truth.objects = {{box(1, 1, 3, 2), "police_car"}, {box(5, 1, 6, 2), "table"}, {box(6.5, 3, 7, 3.5), "plant"}};
  found.objects = {{box(1, 1, 2.9, 2), "car"}, {box(5, 1, 6, 1.9), "desk"}, {box(6.5, 3, 7.1, 3.5), ""}, {box(1, 3, 2, 4), "car"}};
  const ObjectScores scores = score(found, truth).objects;
  CHECK(scores.found == 4);
  CHECK(scores.matched == 3);
  CHECK(scores.named == 2);
  CHECK(scores.named_right == 1);
  found.objects[1].class_name = "table";
  CHECK(score(found, truth).objects.named_right == 2);
  found.objects.clear();
  CHECK(score(found, truth).objects.matched == 0);
}

TEST_CASE("GeoJSON is read with its holes, and a wrong feature is named", "[evaluation]") {
  const auto file = [](const std::string& features) {
    return R"({"type":"FeatureCollection","features":[)" + features + "]}";
  };
  const std::string wall =
      R"({"properties":{"kind":"wall","id":3},"geometry":{"type":"LineString","coordinates":[[0,0],[1,0],[1,2]]}})";
  const std::string room =
      R"({"properties":{"kind":"room","id":"r"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[2,1],[2,2],[1,2],[1,1]]]}})";
  const std::string door =
      R"({"properties":{"kind":"door","id":1,"rooms":[0,5],"state":"closed"},"geometry":{"type":"LineString","coordinates":[[0,0],[1,0]]}})";
  const SemanticMap map = parse_semantic_map(file(wall + "," + room + "," + door));
  CHECK(map.walls.size() == 2);
  REQUIRE(map.rooms.size() == 1);
  CHECK(map.rooms[0].polygon.outline.size() == 4);
  CHECK(area_m2(map.rooms[0].polygon) == Approx(15));
  CHECK(map.doors[0].closed);
  CHECK(map.doors[0].room_a.empty());
  CHECK(map.doors[0].room_b == "5");
  CHECK_THROWS_WITH(parse_semantic_map("{"),
                    Catch::Contains("not JSON") || Catch::Contains("is not JSON"));
  CHECK_THROWS_WITH(parse_semantic_map("[]"), Catch::Contains("FeatureCollection"));
  for (
      const char* bad :
      {"7", "{}",
       R"({"properties":{"kind":"wall"},"geometry":{"type":"Point","coordinates":[0,0]}})",
       R"({"properties":{"kind":"wall"},"geometry":{"type":"LineString","coordinates":[[0,0]]}})",
       R"({"properties":{"kind":"wall","ends":[{"across_m":0.1,"along_m":0.1,"seen":true}]},"geometry":{"type":"LineString","coordinates":[[0,0],[1,0]]}})",
       R"({"properties":{"kind":"wall","ends":[{"seen":true},{"seen":true}]},"geometry":{"type":"LineString","coordinates":[[0,0],[1,0]]}})",
       R"({"properties":{"kind":"room"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,"x"],[1,1]]]}})",
       R"({"properties":{"kind":"room"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1e9,0],[1,1]]]}})",
       R"({"properties":{"kind":5},"geometry":null})"}) {
    INFO(bad);
    CHECK_THROWS_WITH(parse_semantic_map(file(wall + "," + bad)), Catch::Contains("feature 2"));
  }
}
