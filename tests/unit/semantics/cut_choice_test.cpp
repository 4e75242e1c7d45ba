// SPDX-License-Identifier: BSD-3-Clause
/// Which openings are cut.
#include "common/semantics/cut_choice.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <iterator>
#include <set>

#include "common/world/random.hpp"

using namespace modslam;

namespace {

Gap any_gap(RandomStream& random) {
  const Eigen::Vector2d a(random.uniform(0, 15), random.uniform(0, 15));
  const double angle = random.uniform(-3, 3), width_m = random.uniform(0.4, 3.4);
  // Trees tell few different probabilities.
  return {a, a + width_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)), 0.5 + 0.05 * std::floor(random.uniform(0, 9.9))};
}

bool is_surer(const Gap& p, const Gap& q) { return p.order() < q.order(); }

/// Tells the choice what it takes to come from one set of gaps to the other. @return the chosen ones, surest first.
std::vector<Gap> chosen_after(CutChoice& choice, std::vector<Gap> before, std::vector<Gap> now) {
  GapNews news;
  std::sort(before.begin(), before.end(), is_surer);
  std::sort(now.begin(), now.end(), is_surer);
  std::set_difference(before.begin(), before.end(), now.begin(), now.end(), std::back_inserter(news.gone), is_surer);
  std::set_difference(now.begin(), now.end(), before.begin(), before.end(), std::back_inserter(news.come), is_surer);
  std::set<std::size_t> expected(choice.chosen().begin(), choice.chosen().end());
  const NumberNews change = choice.update(news);
  for (const std::size_t number : change.gone) REQUIRE(expected.erase(number) == 1);
  for (const std::size_t number : change.come) REQUIRE(expected.insert(number).second);
  REQUIRE(expected == std::set<std::size_t>(choice.chosen().begin(), choice.chosen().end()));
  std::vector<Gap> out;
  for (const std::size_t number : choice.chosen()) out.push_back(choice[number]);
  return out;
}

bool same(const std::vector<Gap>& p, const std::vector<Gap>& q) {
  return std::equal(p.begin(), p.end(), q.begin(), q.end(), [](const Gap& one, const Gap& other) { return one.order() == other.order(); });
}

}  // namespace

TEST_CASE("of two cuts across each other the surer one is made, and the other when that goes") {
  const Gap sure{{0, 0}, {1, 0}, 0.9}, across{{0.5, -0.5}, {0.5, 0.5}, 0.8}, apart{{5, 0}, {6, 0}, 0.7};
  CutChoice choice;
  REQUIRE(same(chosen_after(choice, {}, {across, apart, sure}), {sure, apart}));
  REQUIRE(same(chosen_after(choice, {across, apart, sure}, {across, apart}), {across, apart}));
  REQUIRE(same(chosen_after(choice, {across, apart}, {sure, across, apart}), {sure, apart}));
  REQUIRE(chosen_after(choice, {sure, across, apart}, {}).empty());
}

TEST_CASE("whatever gaps come, go and become surer, those are cut that a fresh look at all of them would cut") {
  RandomStream random(921, RandomStreamId::kLaser);
  std::vector<Gap> gaps;
  CutChoice choice;
  for (int round = 0; round < 400; ++round) {
    const std::vector<Gap> before = gaps;
    for (int k = 0; k < 6; ++k) {
      const auto place = static_cast<std::size_t>(random.uniform(0, static_cast<double>(gaps.size()) - 1e-9));
      const double what = random.uniform(0, 1);
      if (what < 0.5 || gaps.empty()) gaps.push_back(any_gap(random));
      else if (what < 0.75) gaps[place].probability = 0.5 + 0.05 * std::floor(random.uniform(0, 9.9));
      else gaps.erase(gaps.begin() + static_cast<std::ptrdiff_t>(place));
    }
    while (gaps.size() > 80) gaps.erase(gaps.begin() + static_cast<std::ptrdiff_t>(random.uniform(0, 79.9)));
    CutChoice fresh;
    REQUIRE(same(chosen_after(choice, before, gaps), chosen_after(fresh, {}, gaps)));
  }
}
