// SPDX-License-Identifier: BSD-3-Clause
#include "common/maps/beam_counts.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "common/world/random.hpp"

using namespace modslam;

namespace {

using Counts = std::map<BeamCounts::Cell, int>;
constexpr int kTile = BeamCounts::kTileCells;

Counts taken(BeamCounts& beams, int sign = 1) {
  Counts out;
  for (const auto& tile : beams.tiles()) {
    std::vector<std::int32_t> numbers(kTile * kTile, 0);
    beams.pour(tile, sign, numbers.data());
    for (int k = 0; k < kTile * kTile; ++k)
      if (numbers[static_cast<std::size_t>(k)]) out[{tile.first * kTile + k % kTile, tile.second * kTile + k / kTile}] += numbers[static_cast<std::size_t>(k)];
  }
  return out;
}

Counts drawn(const Eigen::Vector2d& eye, const std::vector<BeamCounts::Beam>& ends, BeamCounts beams = {}) {
  beams.draw(eye, ends.data(), ends.data() + ends.size());
  return taken(beams);
}

/// The length of a segment within a cell, by clipping.
double length_within(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const BeamCounts::Cell& cell) {
  double from = 0, to = 1;
  for (const int axis : {0, 1}) {
    const double d = b[axis] - a[axis], low = cell[axis] - a[axis], high = low + 1;
    if (d == 0) {
      if (low > 0 || high <= 0) return 0;
      continue;
    }
    from = std::max(from, std::min(low / d, high / d));
    to = std::min(to, std::max(low / d, high / d));
  }
  return std::max(0.0, to - from) * (b - a).norm();
}

}  // namespace

TEST_CASE("a beam along a row counts its cells once, the one it hits not at all") {
  CHECK(drawn({0.5, 0.5}, {{{3.5, 0.5}, true}}) == Counts{{{0, 0}, 1}, {{1, 0}, 1}, {{2, 0}, 1}});
  CHECK(drawn({0.5, 0.5}, {{{-2.5, 0.5}, false}}) == Counts{{{-3, 0}, 1}, {{-2, 0}, 1}, {{-1, 0}, 1}, {{0, 0}, 1}});
  CHECK(drawn({0.2, 0.5}, {{{0.8, 0.1}, true}}).empty());
  CHECK(drawn({0.2, 0.5}, {{{0.8, 0.1}, false}}) == Counts{{{0, 0}, 1}});
}

TEST_CASE("beams count the cells that clipping finds, near and across sheets") {
  RandomStream random(7, RandomStreamId::kLaser);
  for (const double reach : {2.0, 40.0, 1500.0})
    for (int drive = 0; drive < 40; ++drive) {
      const auto anywhere = [&] { return Eigen::Vector2d(random.uniform(-reach, reach), random.uniform(-reach, reach)); };
      const Eigen::Vector2d eye = anywhere(), end = anywhere();
      const Counts counts = drawn(eye, {{end, false}});
      double covered = 0;
      for (const auto& [cell, times] : counts) {
        CHECK(times == 1);
        covered += length_within(eye, end, cell);
      }
      CHECK(covered == Approx((end - eye).norm()).margin(1e-6));  // none is missing
      const BeamCounts::Cell a = {static_cast<int>(std::floor(eye.x())), static_cast<int>(std::floor(eye.y()))}, b = BeamCounts::Beam{end, false}.end_cell();
      CHECK(static_cast<int>(counts.size()) == std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + 1);  // none is too many
      Counts hit = drawn(eye, {{end, true}});
      hit[b] += 1;
      CHECK(hit == counts);
    }
}

TEST_CASE("the counts of a scan are the sum of its beams, and are gone once poured") {
  RandomStream random(11, RandomStreamId::kLaser);
  const Eigen::Vector2d eye(-3.3, 700.2);
  std::vector<BeamCounts::Beam> beams;
  Counts sum;
  for (int k = 0; k < 200; ++k) {
    beams.push_back({eye + Eigen::Vector2d(random.uniform(-600, 600), random.uniform(-600, 600)), k % 3 > 0});
    for (const auto& [cell, times] : drawn(eye, {beams.back()})) sum[cell] += times;
  }
  BeamCounts counts;
  counts.draw(eye, beams.data(), beams.data() + beams.size());
  CHECK(taken(counts) == sum);
  CHECK(counts.tiles().empty());
  counts.draw(eye, beams.data(), beams.data() + beams.size());
  for (auto& [cell, times] : sum) times = -times;
  CHECK(taken(counts, -1) == sum);
}

TEST_CASE("beams through corners and along borders cross as many borders as lie between their ends") {
  const auto total = [](const Counts& counts) {
    int sum = 0;
    for (const auto& [cell, times] : counts) sum += times;
    return sum;
  };
  for (const Eigen::Vector2d& end : {Eigen::Vector2d(5, 5), Eigen::Vector2d(-5, 5), Eigen::Vector2d(5, 0), Eigen::Vector2d(0, -5), Eigen::Vector2d(0, 0)}) {
    const BeamCounts::Cell last = BeamCounts::Beam{end, false}.end_cell();
    const int borders = std::abs(last[0]) + std::abs(last[1]);
    CHECK(total(drawn({0, 0}, {{end, false}})) == borders + 1);
    CHECK(total(drawn({0, 0}, {{end, true}})) == borders);
  }
}
