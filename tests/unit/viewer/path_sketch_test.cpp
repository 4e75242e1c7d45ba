// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/path_sketch.hpp"

#include <catch2/catch.hpp>

namespace modslam {
namespace {

double to_segment_m(const Triple& p, const Triple& a, const Triple& b) {
  const Eigen::Vector2d d(b[0] - a[0], b[1] - a[1]), q(p[0] - a[0], p[1] - a[1]);
  const double share = d.squaredNorm() > 0 ? std::clamp(q.dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (q - share * d).norm();
}

double farthest_m(const std::vector<Triple>& path, const std::vector<Triple>& line) {
  double farthest = 0;
  for (const Triple& p : path) {
    double nearest = 1e9;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) nearest = std::min(nearest, to_segment_m(p, line[k], line[k + 1]));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

/// Ever wider loops, a centimetre a step.
std::vector<Triple> spiral(double length_m) {
  std::vector<Triple> path;
  double heading = 0;
  Triple at{};
  for (double s = 0; s < length_m; s += 0.01) {
    heading += 0.01 / (0.5 + 0.02 * s);
    at = {at[0] + 0.01 * std::cos(heading), at[1] + 0.01 * std::sin(heading), heading};
    path.push_back(at);
  }
  return path;
}

TEST_CASE("a curved path is drawn within a tolerance in a tenth of its points") {
  Trail trail("truth");
  PathSketch sketch(trail);
  const std::vector<Triple> path = spiral(60);
  for (const Triple& place : path) sketch.add(place);
  CHECK(sketch.tolerance_m() == PathSketch::kFinest_m);
  CHECK(trail.triples().size() < path.size() / 10);
  CHECK(farthest_m(path, trail.triples()) < 2 * PathSketch::kFinest_m);
}

TEST_CASE("a straight path is two points, there and back three") {
  Trail trail("truth");
  PathSketch sketch(trail);
  for (int k = 0; k <= 500; ++k) sketch.add({0.02 * k, 0, 0});
  CHECK(trail.triples().size() == 2);
  for (int k = 500; k >= 0; --k) sketch.add({0.02 * k, 0, 0});
  REQUIRE(trail.triples().size() == 3);
  CHECK(trail.triples()[1][0] == Approx(10.0).margin(0.02));
  CHECK(trail.triples()[2][0] == Approx(0.0).margin(0.02));
}

TEST_CASE("a path of many corners is kept whole, only coarser, and whoever stands still adds nothing") {
  Trail trail("truth");
  PathSketch sketch(trail);
  std::vector<Triple> path;
  for (int k = 0; k < 15'000; ++k) path.push_back({0.2 * k, k % 2 ? 0.1 : 0.0, 0});
  for (const Triple& place : path) sketch.add(place);
  CHECK(trail.triples().size() <= PathSketch::kMost);
  CHECK(sketch.tolerance_m() <= 0.16);
  CHECK(trail.triples().front() == path.front());
  CHECK(trail.triples().back()[0] == Approx(path.back()[0]).margin(0.5));
  for (std::size_t k = 0; k < path.size(); k += 97) REQUIRE(farthest_m({path[k]}, trail.triples()) < 0.3);
  const std::vector<Triple> before = trail.triples();
  for (int k = 0; k < 100; ++k) sketch.add(path.back());
  CHECK(trail.triples() == before);
}

}  // namespace
}  // namespace modslam
