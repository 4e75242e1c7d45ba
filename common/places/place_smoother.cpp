// SPDX-License-Identifier: BSD-3-Clause
#include "common/places/place_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace modslam {
namespace {

/// Neighbouring panoramas show much the same: that share of what each says is news.
constexpr double kNews = 0.5;
constexpr double kNewsOfRoom = 0.5;  // the same of what the nodes of a room say in the mean
constexpr double kInDoorway = 0.5;   // surer ones say nothing of the room
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

std::vector<PlaceConfidence> smooth_places(const std::vector<PlaceConfidence>& seen, const PlaceTransitions& transitions,
                                           const std::vector<PlaceConfidence>& told) {
  const auto news_of = [&](std::size_t n) {
    PlaceConfidence out = evidence(seen[n]);
    if (n < told.size())
      for (std::size_t k = 0; k < kPlaceKinds; ++k) out[k] *= told[n][k];
    return out;
  };
  std::vector<PlaceConfidence> out(seen.size());
  PlaceConfidence belief = {1, 1, 1};
  for (std::size_t n = 0; n < seen.size(); ++n) {
    const PlaceConfidence news = news_of(n);
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
    const PlaceConfidence news = news_of(n);
    PlaceConfidence before{};
    for (std::size_t from = 0; from < kPlaceKinds; ++from)
      for (std::size_t to = 0; to < kPlaceKinds; ++to) before[from] += transitions[from][to] * news[to] * ahead[to];
    normalise(before);
    ahead = before;
  }
  return out;
}

std::vector<PlaceConfidence> told_by_map(const std::vector<PlaceConfidence>& seen, const std::vector<PlaceOnMap>& on_map, const PlaceModel& model) {
  constexpr auto room = static_cast<std::size_t>(PlaceKind::kRoom), corridor = static_cast<std::size_t>(PlaceKind::kCorridor),
                 doorway = static_cast<std::size_t>(PlaceKind::kDoorway);
  struct Sum {
    double log_odds = 0;  // of corridor against room
    int nodes = 0;
  };
  const std::size_t nodes = std::min(seen.size(), on_map.size());
  std::map<int, Sum> rooms;
  for (std::size_t n = 0; n < nodes; ++n) {
    if (on_map[n].room < 0 || seen[n][doorway] >= kInDoorway) continue;
    Sum& sum = rooms[on_map[n].room];
    sum.log_odds += std::log(std::max(seen[n][corridor], kLeast) / std::max(seen[n][room], kLeast));
    ++sum.nodes;
  }
  std::vector<PlaceConfidence> out;
  for (std::size_t n = 0; n < nodes; ++n) {
    out.push_back(model.likelihood(on_map[n].hint));
    const auto around = rooms.find(on_map[n].room);
    if (around == rooms.end()) continue;
    const double odds = std::exp(kNewsOfRoom * around->second.log_odds / around->second.nodes);
    out[n][corridor] *= std::sqrt(odds);
    out[n][room] /= std::sqrt(odds);
  }
  return out;
}

}  // namespace modslam
