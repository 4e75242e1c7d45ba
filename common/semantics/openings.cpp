// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/openings.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/semantics/cut_features.hpp"

namespace modslam {
namespace {

using Vec = Eigen::Vector2d;

constexpr int kPerCorner = 6;            // shortest cuts kept from each corner
constexpr double kNarrowest_m = 0.3, kTwins_m = 0.12, kNear_m = 0.2;
constexpr double kHalo_m = 1.05;         // of a block's outline
constexpr double kFarthestLook_m = 4.3;
constexpr int kAtWall = 6;               // [cells] of a wall at the end of a cut

auto order_of(const Vec& p) { return std::pair(p.x(), p.y()); }
auto order_of(const FloorCut& cut) { return std::tuple(cut.length(), cut.a.x(), cut.a.y(), cut.b.x(), cut.b.y()); }

cv::Rect box_of(const Vec& p, const Vec& q) {
  const Vec low = p.cwiseMin(q), high = p.cwiseMax(q);
  return {cv::Point(cvFloor(low.x()), cvFloor(low.y())), cv::Point(cvFloor(high.x()) + 2, cvFloor(high.y()) + 2)};
}

bool is_in(const cv::Rect& block, const Vec& p) { return p.x() >= block.x && p.y() >= block.y && p.x() < block.br().x && p.y() < block.br().y; }

bool same(const Corner& p, const Corner& q) { return p.p == q.p && p.before == q.before && p.after == q.after && p.turn_rad == q.turn_rad; }
bool same(const Edge& p, const Edge& q) { return p.a == q.a && p.b == q.b; }
bool same(const FloorCut& p, const FloorCut& q) {
  return p.a == q.a && p.b == q.b && p.edge == q.edge && same(p.first, q.first) && p.to_corner == q.to_corner && same(p.second, q.second);
}
cv::Rect box_of(const Corner& corner) { return box_of(corner.p, corner.p); }
cv::Rect box_of(const Edge& edge) { return box_of(edge.a, edge.b); }
cv::Rect box_of(const FloorCut& cut) { return box_of(cut.centre(), cut.centre()); }

/// Boxes of what only one of the two has.
template <class Thing>
void note_news(const std::vector<Thing>& before, const std::vector<Thing>& now, Boxes& news) {
  const auto note = [&](const std::vector<Thing>& these, const std::vector<Thing>& those) {
    for (const Thing& thing : these)
      if (std::none_of(those.begin(), those.end(), [&](const Thing& other) { return same(thing, other); })) news.push_back(box_of(thing));
  };
  note(before, now);
  note(now, before);
}

/// A cut from a corner that may be kept.
struct Candidate {
  double length;
  Vec b;
  const Corner* corner;   ///< at b; none: it lies on an edge
  const Edge* edge;
  auto order() const { return std::tuple(length, b.x(), b.y()); }
  bool operator<(const Candidate& o) const { return order() > o.order(); }  // so that a heap has the shortest at its top
};

FloorCut cut_of(const Corner& from, const Candidate& to) {
  if (to.corner) return {from.p, to.b, from, *to.corner};
  return {from.p, to.b, from, {}, false, (to.edge->b - to.edge->a).normalized()};
}

/// The shortest cuts from one corner that are clear.
void keep_shortest(const Floor& floor, const Corner& from, std::vector<Candidate>& cuts, std::vector<FloorCut>& kept) {
  std::make_heap(cuts.begin(), cuts.end());
  for (int count = 0; !cuts.empty() && count < kPerCorner; cuts.pop_back()) {
    std::pop_heap(cuts.begin(), cuts.end());
    const Candidate& cut = cuts.back();
    if (!is_clear(floor, from.p, cut.b)) continue;
    ++count;
    if (!cut.corner || order_of(from.p) < order_of(cut.b)) kept.push_back(cut_of(from, cut));  // a cut between corners is met from both
  }
}

void drop_twins(std::vector<FloorCut>& cuts, double near) {
  std::sort(cuts.begin(), cuts.end(), [](const FloorCut& p, const FloorCut& q) { return order_of(p) < order_of(q); });
  std::vector<FloorCut> kept;
  for (const FloorCut& cut : cuts) {
    const bool twin = std::any_of(kept.rbegin(), kept.rend(), [&](const FloorCut& other) {
      if (((cut.a + cut.b - other.a - other.b).array().abs() > 2 * near).any()) return false;
      return ((cut.a - other.a).norm() < near && (cut.b - other.b).norm() < near) || ((cut.a - other.b).norm() < near && (cut.b - other.a).norm() < near);
    });
    if (!twin) kept.push_back(cut);
  }
  cuts = std::move(kept);
}

}  // namespace

std::vector<const OpeningMap::Block*> OpeningMap::around(const Index& index) const {
  std::vector<const Block*> out;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (const auto found = blocks_.find({index.first + dx, index.second + dy}); found != blocks_.end()) out.push_back(&found->second);
  return out;
}

Boxes OpeningMap::retrace(const Floor& floor, const Boxes& open) {
  Boxes news;
  const int halo = static_cast<int>(kHalo_m / floor.resolution_m);
  std::map<Index, bool> stirred;
  for (const cv::Rect& box : windows(open, halo, floor.open.size()))
    for (int row = box.y / kPlanBlock; row * kPlanBlock < box.br().y; ++row)
      for (int column = box.x / kPlanBlock; column * kPlanBlock < box.br().x; ++column) stirred[{column, row}] = true;
  for (const auto& [index, yes] : stirred) {
    Block& block = blocks_[index];
    block.box = cv::Rect(index.first * kPlanBlock, index.second * kPlanBlock, kPlanBlock, kPlanBlock) & cv::Rect({0, 0}, floor.open.size());
    if (!meet(open, grown(block.box, halo))) continue;
    Outline outline = trace(floor, block.box);
    note_news(block.outline.corners, outline.corners, news);
    note_news(block.outline.edges, outline.edges, news);
    block.outline = std::move(outline);
  }
  return news;
}

Boxes OpeningMap::recollect(const Floor& floor, const Boxes& changed) {
  Boxes news;
  const double reach = max_width_m_ / floor.resolution_m, shortest = kNarrowest_m / floor.resolution_m;
  const cv::Rect all = bounds(changed);
  for (auto& [index, block] : blocks_) {
    if (!meet(all, grown(block.box, static_cast<int>(reach) + 2)) || !meet(changed, grown(block.box, static_cast<int>(reach) + 2))) continue;
    std::vector<FloorCut> cuts;
    std::vector<Candidate> to_corners, to_edges;
    const std::vector<const Block*> neighbours = around(index);
    for (const Corner& corner : block.outline.corners) {
      to_corners.clear();
      to_edges.clear();
      const auto length_of = [&](const Vec& end) { return (end - corner.p).norm(); };
      const auto fits = [&](double length) { return length >= shortest && length <= reach; };
      const cv::Rect near = grown(box_of(corner), static_cast<int>(reach) + 1);
      for (const Block* other : neighbours) {
        if (!meet(near, other->box)) continue;
        for (const Corner& end : other->outline.corners)
          if (const double length = length_of(end.p); fits(length)) to_corners.push_back({length, end.p, &end, nullptr});
        for (const Edge& edge : other->outline.edges) {
          const Vec d = edge.b - edge.a;
          const double share = d.dot(corner.p - edge.a) / d.squaredNorm();
          if (!(share > 0.02 && share < 0.98)) continue;
          const Vec foot = edge.a + share * d;
          if (const double length = length_of(foot); fits(length) && is_in(other->box, foot)) to_edges.push_back({length, foot, nullptr, &edge});
        }
      }
      keep_shortest(floor, corner, to_corners, cuts);
      keep_shortest(floor, corner, to_edges, cuts);
    }
    drop_twins(cuts, kTwins_m / floor.resolution_m);
    note_news(block.cuts, cuts, news);
    block.cuts = std::move(cuts);
  }
  return news;
}

double OpeningMap::narrowest_near(const Index& index, const FloorCut& cut, double cell_m) const {
  double narrowest = cut.length();
  for (const Block* other : around(index))
    for (const FloorCut& near : other->cuts) {
      if (near.length() >= narrowest) break;  // shortest first
      if ((near.centre() - cut.centre()).norm() < 0.5 * cut.length() + kNear_m / cell_m) narrowest = near.length();
    }
  return narrowest;
}

/// Measures anew what lies near a change, and of the rest the walls where they changed.
void OpeningMap::measure(const Index& index, const CutFeatures& features, const KnownSpace& space, const Boxes& changed, const Boxes& walls_changed) {
  Block& block = blocks_.at(index);
  const double cell_m = space.resolution_m;
  std::vector<Opening> openings;
  for (const FloorCut& cut : block.cuts) {
    const Vec a = space.origin_m + cell_m * (cut.a + Vec(0.5, 0.5)), b = space.origin_m + cell_m * (cut.b + Vec(0.5, 0.5));
    const auto known = std::find_if(block.openings.begin(), block.openings.end(), [&](const Opening& o) { return o.a == a && o.b == b; });
    bool news = known == block.openings.end() || meet(changed, CutFeatures::reach(cut, cell_m));
    openings.push_back(news ? features.measure(cut, narrowest_near(index, cut, cell_m)) : *known);
    if (!news && (meet(walls_changed, grown(box_of(cut.a, cut.a), kAtWall)) || meet(walls_changed, grown(box_of(cut.b, cut.b), kAtWall))))
      news = features.measure_walls(openings.back());
    if (news) openings.back().probability = model_.probability(openings.back().features.data());
  }
  std::sort(openings.begin(), openings.end(), [](const Opening& p, const Opening& q) { return p.probability > q.probability; });
  block.openings = std::move(openings);
}

void OpeningMap::update(const Floor& floor, const KnownSpace& space, const WallSet& walls, const FloorChange& change, const Boxes& walls_changed) {
  if (floor.open.empty()) return;
  // The large boxes first: who asks whether any is near needs no more.
  Boxes corners = change.open, changed = change.open;
  const auto add = [](Boxes& boxes, const Boxes& more) { boxes.insert(boxes.end(), more.begin(), more.end()); };
  add(corners, retrace(floor, change.open));
  for (const Boxes& more : {change.clearance, change.solid, recollect(floor, corners)}) add(changed, more);

  const CutFeatures features(floor, space, walls);
  const int reach = static_cast<int>(max_width_m_ / floor.resolution_m) + 2;
  const int look = reach + static_cast<int>(std::max(kFarthestLook_m, 4 * max_width_m_) / floor.resolution_m) + 2;
  const auto near = [&](const Boxes& boxes, const cv::Rect& all, const cv::Rect& around) {
    const cv::Rect box = around & cv::Rect({0, 0}, floor.open.size());
    Boxes out;
    if (!meet(all, box)) return out;
    for (const cv::Rect& other : boxes) {
      const cv::Rect here = other & box;
      if (here == box) return Boxes{box};
      const auto holds = [&](const cv::Rect& larger) { return (larger & here) == here; };
      if (here.area() > 0 && std::none_of(out.begin(), out.end(), holds)) out.push_back(other);
    }
    return out;
  };
  const cv::Rect all_changed = bounds(changed), all_walls = bounds(walls_changed);
  for (const auto& [index, block] : blocks_) {
    const Boxes changed_here = near(changed, all_changed, grown(block.box, look)), walls_here = near(walls_changed, all_walls, grown(block.box, reach + kAtWall));
    if (!changed_here.empty() || !walls_here.empty()) measure(index, features, space, changed_here, walls_here);
  }
}

std::vector<Opening> OpeningMap::openings(const CutLimits& limits) const {
  std::vector<const Opening*> sure;
  for (const auto& [index, block] : blocks_)
    for (const Opening& opening : block.openings) {
      if (opening.probability < limits.least_probability()) break;  // surest first
      if (limits.take(opening)) sure.push_back(&opening);
    }
  const auto order = [](const Opening& o) { return std::tuple(-o.probability, o.a.x(), o.a.y(), o.b.x(), o.b.y()); };
  std::sort(sure.begin(), sure.end(), [&](const Opening* p, const Opening* q) { return order(*p) < order(*q); });
  std::vector<Opening> out;
  out.reserve(sure.size());
  for (const Opening* opening : sure) out.push_back(*opening);
  return out;
}

std::vector<Opening> find_openings(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, double max_width_m,
                                   const OpeningModel& model) {
  OpeningMap map(max_width_m, model);
  FloorChange all;
  all.open = {cv::Rect({0, 0}, floor.open.size())};
  WallSet set;
  set.update(walls);
  map.update(floor, space, set, all, {});
  return map.openings({0, 0, 0});
}

}  // namespace modslam
