// SPDX-License-Identifier: BSD-3-Clause
/// Which openings are cut.
#include "common/semantics/cut_choice.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/world/random.hpp"

using namespace modslam;

namespace {

Opening opening(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double probability) {
  Opening out;
  out.a = a;
  out.b = b;
  out.probability = probability;
  return out;
}

Opening any_opening(RandomStream& random) {
  const Eigen::Vector2d a(random.uniform(0, 15), random.uniform(0, 15));
  const double angle = random.uniform(-3, 3), width_m = random.uniform(0.4, 3.4);
  // Trees tell few different probabilities.
  return opening(a, a + width_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)), 0.5 + 0.05 * std::floor(random.uniform(0, 9.9)));
}

void sort_surest_first(std::vector<Opening>& openings) {
  std::sort(openings.begin(), openings.end(), [](const Opening& p, const Opening& q) { return std::tuple(-p.probability, p.a.x()) < std::tuple(-q.probability, q.a.x()); });
}

}  // namespace

TEST_CASE("of two cuts across each other the surer one is made, and the other when that goes") {
  const Opening sure = opening({0, 0}, {1, 0}, 0.9), across = opening({0.5, -0.5}, {0.5, 0.5}, 0.8), apart = opening({5, 0}, {6, 0}, 0.7);
  CutChoice choice;
  REQUIRE(choice.update({sure, across, apart}) == std::vector<std::size_t>{0, 2});
  REQUIRE(choice.update({across, apart}) == std::vector<std::size_t>{0, 1});
  REQUIRE(choice.update({sure, across, apart}) == std::vector<std::size_t>{0, 2});
  REQUIRE(choice.update({}).empty());
}

TEST_CASE("whatever openings come, go and become surer, those are cut that a fresh look at all of them would cut") {
  RandomStream random(921, RandomStreamId::kLaser);
  std::vector<Opening> openings;
  CutChoice choice;
  for (int round = 0; round < 400; ++round) {
    for (int k = 0; k < 6; ++k) {
      const auto place = static_cast<std::size_t>(random.uniform(0, static_cast<double>(openings.size()) - 1e-9));
      const double what = random.uniform(0, 1);
      if (what < 0.5 || openings.empty()) openings.push_back(any_opening(random));
      else if (what < 0.75) openings[place].probability = 0.5 + 0.05 * std::floor(random.uniform(0, 9.9));
      else openings.erase(openings.begin() + static_cast<std::ptrdiff_t>(place));
    }
    while (openings.size() > 80) openings.erase(openings.begin() + static_cast<std::ptrdiff_t>(random.uniform(0, 79.9)));
    std::vector<Opening> listed = openings;
    sort_surest_first(listed);
    CutChoice fresh;
    REQUIRE(choice.update(listed) == fresh.update(listed));
  }
}
