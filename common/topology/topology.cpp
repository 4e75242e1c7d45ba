// SPDX-License-Identifier: BSD-3-Clause
#include "common/topology/topology.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/graph/disjoint_sets.hpp"
#include "common/semantics/room_finder.hpp"

namespace modslam {
namespace {

constexpr double kBeside_m = 0.6;      // a point in a doorway belongs to the room next to it
constexpr double kStep_m = 4.0;         // between nodes of one way; they stand a third of a metre apart where the map is new
constexpr std::size_t kLostNodes = 10;  // so many nodes in no room, and what came before is no neighbour

double distance_to_outline(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d &a = outline[k], d = outline[(k + 1) % outline.size()] - a;
    const double t = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
    least = std::min(least, (a + t * d - p).norm());
  }
  return least;
}

/// Boxes of the rooms, so that most are passed over at a glance.
class RoomIndex {
 public:
  explicit RoomIndex(const std::vector<Room>& rooms) : rooms_(rooms) {
    for (const Room& room : rooms) {
      Box box;
      for (const Eigen::Vector2d& p : room.outline) box.low = box.low.cwiseMin(p), box.high = box.high.cwiseMax(p);
      boxes_.push_back(box);
    }
  }
  std::optional<std::size_t> holding(const Eigen::Vector2d& p) const {
    for (std::size_t k = 0; k < rooms_.size(); ++k)
      if ((p.array() >= boxes_[k].low.array()).all() && (p.array() <= boxes_[k].high.array()).all() && contains(rooms_[k].outline, p)) return k;
    return std::nullopt;
  }

 private:
  struct Box {
    Eigen::Vector2d low{1e300, 1e300}, high{-1e300, -1e300};
  };
  const std::vector<Room>& rooms_;
  std::vector<Box> boxes_;
};

/// The place inside that is farthest from the outline, on a grid of 24 by 24.
Eigen::Vector2d middle_of(const Room& room) {
  constexpr int kGrid = 24;
  if (room.outline.empty()) return {0, 0};
  Eigen::Vector2d low = room.outline[0], high = low, best = low;
  for (const Eigen::Vector2d& p : room.outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
  double most = -1;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) {
      const Eigen::Vector2d p = low + (high - low).cwiseProduct(Eigen::Vector2d(i + 0.5, j + 0.5)) / kGrid;
      if (!contains(room.outline, p)) continue;
      const double clear = distance_to_outline(room.outline, p);
      if (clear > most) most = clear, best = p;
    }
  return best;
}

bool joined(const Topology& topology, std::size_t a, std::size_t b) {
  return std::any_of(topology.passages.begin(), topology.passages.end(), [&](const Passage& passage) {
    return (passage.room_a == a && passage.room_b == b) || (passage.room_a == b && passage.room_b == a);
  });
}

void add_doors(const SemanticLayers& layers, Topology& topology) {
  std::map<std::int64_t, std::size_t> index;
  for (std::size_t k = 0; k < topology.rooms.size(); ++k) index[topology.rooms[k].id] = k;
  for (const Door& door : layers.doors) {
    const auto a = index.find(door.room_a), b = index.find(door.room_b);
    if (a == index.end() || b == index.end() || a == b || !door.centre().allFinite()) continue;
    topology.passages.push_back({door.id, a->second, b->second, door.centre()});
  }
}

/// Follows the path through the rooms: where it changes rooms there is a way.
void follow(const std::vector<Eigen::Vector2d>& path, Topology& topology) {
  const RoomIndex index(topology.rooms);
  const std::size_t none = topology.rooms.size();
  std::size_t room = none;  // the one that the path was in last
  Eigen::Vector2d left{0, 0};
  std::size_t lost = 0;
  for (const Eigen::Vector2d& p : path) {
    const std::size_t now = p.allFinite() ? index.holding(p).value_or(none) : none;
    topology.room_of_node.push_back(now == none ? 0 : topology.rooms[now].id);
    if (now == none) {
      if (++lost > kLostNodes) room = none;
      continue;
    }
    // Where the robot drove through known space no node was made: what lies far apart is not one step.
    const bool one_step = (p - left).norm() < kStep_m;
    if (room != none && room != now && one_step && !joined(topology, room, now)) topology.passages.push_back({0, room, now, 0.5 * (left + p)});
    room = now;
    left = p;
    lost = 0;
  }
}

/// Rooms that hang together are one building.
void number_buildings(Topology& topology) {
  DisjointSets sets(topology.rooms.size());
  for (const Passage& passage : topology.passages) sets.join(passage.room_a, passage.room_b);
  std::map<std::size_t, std::int64_t> smallest;
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const auto [at, first] = smallest.emplace(sets.root(k), topology.rooms[k].id);
    if (!first) at->second = std::min(at->second, topology.rooms[k].id);
  }
  for (std::size_t k = 0; k < sets.size(); ++k) topology.building.push_back(smallest[sets.root(k)]);
}

}  // namespace

Topology build_topology(const SemanticLayers& layers, const std::vector<Eigen::Vector2d>& path) {
  Topology topology;
  for (const Room& room : layers.rooms)
    if (room.outline.size() > 2 && std::all_of(room.outline.begin(), room.outline.end(), [](const auto& p) { return p.allFinite(); }))
      topology.rooms.push_back(room);
  for (const Room& room : topology.rooms) topology.middles.push_back(middle_of(room));
  add_doors(layers, topology);
  follow(path, topology);
  number_buildings(topology);
  return topology;
}

std::optional<std::size_t> room_at(const Topology& topology, const Eigen::Vector2d& p) {
  if (!p.allFinite()) return std::nullopt;
  if (const auto holding = RoomIndex(topology.rooms).holding(p)) return holding;
  std::optional<std::size_t> nearest;
  double least = kBeside_m;
  for (std::size_t k = 0; k < topology.rooms.size(); ++k) {
    const double apart = distance_to_outline(topology.rooms[k].outline, p);
    if (apart <= least) least = apart, nearest = k;
  }
  return nearest;
}

std::optional<RoomRoute> find_route(const Topology& topology, const RoomPlace& from, const RoomPlace& to) {
  if (from.room == to.room) return RoomRoute{{from.room}, {}, {from.p, to.p}, (from.p - to.p).norm()};
  // Dijkstra over passages; a state is (passage, the side that one comes out at), number n is the end.
  const std::vector<Passage>& passages = topology.passages;
  const std::size_t states = 2 * passages.size(), none = states;
  const auto out_of = [&](std::size_t s) { return s % 2 ? passages[s / 2].room_a : passages[s / 2].room_b; };
  const auto into = [&](std::size_t s) { return s % 2 ? passages[s / 2].room_b : passages[s / 2].room_a; };
  std::vector<double> cost(states, std::numeric_limits<double>::infinity());
  std::vector<std::size_t> before(states, none);
  std::vector<bool> settled(states, false);
  for (std::size_t s = 0; s < states; ++s)
    if (into(s) == from.room) cost[s] = (passages[s / 2].p - from.p).norm();
  for (std::size_t round = 0; round < states; ++round) {
    std::size_t at = none;
    for (std::size_t s = 0; s < states; ++s)
      if (!settled[s] && std::isfinite(cost[s]) && (at == none || cost[s] < cost[at])) at = s;
    if (at == none) break;
    settled[at] = true;
    for (std::size_t s = 0; s < states; ++s) {
      if (settled[s] || into(s) != out_of(at)) continue;
      const double price = cost[at] + (passages[s / 2].p - passages[at / 2].p).norm();
      if (price < cost[s]) cost[s] = price, before[s] = at;
    }
  }
  std::size_t last = none;
  const auto whole = [&](std::size_t s) { return cost[s] + (passages[s / 2].p - to.p).norm(); };
  for (std::size_t s = 0; s < states; ++s)
    if (out_of(s) == to.room && std::isfinite(cost[s]) && (last == none || whole(s) < whole(last))) last = s;
  if (last == none) return std::nullopt;
  RoomRoute route{{to.room}, {}, {to.p}, whole(last)};
  for (std::size_t s = last; s != none; s = before[s]) {
    route.rooms.push_back(into(s));
    route.doors.push_back(passages[s / 2].door);
    route.points.push_back(passages[s / 2].p);
  }
  route.points.push_back(from.p);
  std::reverse(route.rooms.begin(), route.rooms.end());
  std::reverse(route.doors.begin(), route.doors.end());
  std::reverse(route.points.begin(), route.points.end());
  return route;
}

}  // namespace modslam
