// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/room_events.hpp"

#include <algorithm>
#include <map>

#include "common/semantics/room_finder.hpp"

namespace modslam {
namespace {

constexpr double kMostly = 0.5, kFinest_m = 0.2;
constexpr int kMostSteps = 40;

/// Rising.
std::vector<std::int64_t> ids_of(const std::vector<Room>& rooms) {
  std::vector<std::int64_t> ids;
  for (const Room& room : rooms) ids.push_back(room.id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

struct Box {
  Eigen::Vector2d low{1e300, 1e300}, high{-1e300, -1e300};
  explicit Box(const Room& room) {
    for (const Eigen::Vector2d& p : room.outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  bool meets(const Box& other) const { return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all(); }
};

/// Whether more than half of a grid of points in `part` lies in `whole`.
bool is_mostly_in(const Room& part, const Box& box, const Room& whole) {
  if (!box.meets(Box(whole))) return false;
  const double step = std::max(kFinest_m, (box.high - box.low).maxCoeff() / kMostSteps);
  int in_part = 0, in_both = 0;
  for (double y = box.low.y() + 0.5 * step; y < box.high.y(); y += step)
    for (double x = box.low.x() + 0.5 * step; x < box.high.x(); x += step) {
      if (!contains(part.outline, {x, y})) continue;
      ++in_part;
      in_both += contains(whole.outline, {x, y});
    }
  return in_both > kMostly * in_part;
}

/// Of rooms that are in one list only: the room of the other list that they mostly lie in, and all that lie in it.
std::map<std::int64_t, std::vector<std::int64_t>> gathered(const std::vector<Room>& parts, const std::vector<Room>& wholes) {
  const std::vector<std::int64_t> known = ids_of(wholes), elsewhere = ids_of(parts);
  const auto has = [](const std::vector<std::int64_t>& ids, std::int64_t id) { return std::binary_search(ids.begin(), ids.end(), id); };
  std::map<std::int64_t, std::vector<std::int64_t>> in;
  for (const Room& part : parts) {
    if (has(known, part.id)) continue;
    const Box box(part);
    const auto whole = std::find_if(wholes.begin(), wholes.end(), [&](const Room& room) { return is_mostly_in(part, box, room); });
    if (whole != wholes.end()) in[whole->id].push_back(part.id);
  }
  for (auto& [whole, ids] : in) {
    if (has(elsewhere, whole)) ids.push_back(whole);
    std::sort(ids.begin(), ids.end());
  }
  return in;
}

}  // namespace

std::vector<RoomEvent> room_events(const std::vector<Room>& before, const std::vector<Room>& now) {
  std::vector<RoomEvent> events;
  if (std::equal(before.begin(), before.end(), now.begin(), now.end(), [](const Room& p, const Room& q) { return p.id == q.id; })) return events;
  for (const auto& [whole, parts] : gathered(before, now))
    if (parts.size() > 1) events.push_back({RoomEvent::Kind::kMerge, parts, {whole}});
  for (const auto& [whole, parts] : gathered(now, before))
    if (parts.size() > 1) events.push_back({RoomEvent::Kind::kSplit, {whole}, parts});
  return events;
}

}  // namespace modslam
