// SPDX-License-Identifier: BSD-3-Clause
#include "common/places/place_smoother.hpp"

#include <cmath>

namespace modslam {
namespace {

/// Neighbouring panoramas show much the same: that share of what each says is news.
constexpr double kNews = 0.5;
constexpr double kLeast = 1e-4;  // no scan rules a kind out

void normalise(PlaceConfidence& p) {
  const double sum = p[0] + p[1] + p[2];
  for (double& v : p) v = sum > 0 ? v / sum : 1.0 / static_cast<double>(kPlaceKinds);
}

PlaceConfidence evidence(const PlaceConfidence& seen) {
  PlaceConfidence out;
  for (std::size_t k = 0; k < kPlaceKinds; ++k) out[k] = std::pow(std::max(seen[k], kLeast), kNews);
  return out;
}

}  // namespace

std::vector<PlaceConfidence> smooth_places(const std::vector<PlaceConfidence>& seen, const PlaceTransitions& transitions) {
  std::vector<PlaceConfidence> out(seen.size());
  PlaceConfidence belief = {1, 1, 1};
  for (std::size_t n = 0; n < seen.size(); ++n) {
    const PlaceConfidence news = evidence(seen[n]);
    PlaceConfidence next{};
    for (std::size_t to = 0; to < kPlaceKinds; ++to) {
      for (std::size_t from = 0; from < kPlaceKinds; ++from) next[to] += belief[from] * (n ? transitions[from][to] : 1.0);
      next[to] *= news[to];
    }
    normalise(next);
    out[n] = belief = next;
  }
  PlaceConfidence ahead = {1, 1, 1};
  for (std::size_t n = seen.size(); n-- > 0;) {
    for (std::size_t k = 0; k < kPlaceKinds; ++k) out[n][k] *= ahead[k];
    normalise(out[n]);
    const PlaceConfidence news = evidence(seen[n]);
    PlaceConfidence before{};
    for (std::size_t from = 0; from < kPlaceKinds; ++from)
      for (std::size_t to = 0; to < kPlaceKinds; ++to) before[from] += transitions[from][to] * news[to] * ahead[to];
    normalise(before);
    ahead = before;
  }
  return out;
}

}  // namespace modslam
