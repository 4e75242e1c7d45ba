// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/openings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

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

/// Boxes that meet a window, without those that others hold there; the window itself when one covers it.
Boxes those_near(const Boxes& boxes, const cv::Rect& window) {
  Boxes out;
  for (const cv::Rect& box : boxes) {
    const cv::Rect here = box & window;
    if (here == window) return {window};
    const auto holds = [&](const cv::Rect& larger) { return (larger & here) == here; };
    if (here.area() > 0 && std::none_of(out.begin(), out.end(), holds)) out.push_back(box);
  }
  return out;
}

/// Cuts are near each other whose middles are no farther apart [cells].
double nearby(const FloorCut& cut, double cell_m) { return 0.5 * cut.length() + kNear_m / cell_m; }

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

/// To so fine a fraction of a cell that whole cells can be added without rounding: a raster that grows may begin at another cell.
Vec on_lattice(const Vec& p) {
  constexpr double kFine = 4294967296.0;
  return {std::round(p.x() * kFine) / kFine, std::round(p.y() * kFine) / kFine};
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

/// Leaves them shortest first.
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

/// Openings are places in the map and stay; all else are cells.
void OpeningMap::grow(const Growth& growth) {
  static_assert(kFrameCells % kPlanBlock == 0, "blocks stay whole when the frame grows");
  const Vec shift(growth.shift.x, growth.shift.y);
  const auto moved = [&](const Index& index) { return Index(index.first + growth.shift.x / kPlanBlock, index.second + growth.shift.y / kPlanBlock); };
  for (std::set<Index>* indices : {&with_news_, &untold_}) {
    std::set<Index> now;
    for (const Index& index : *indices) now.insert(moved(index));
    *indices = std::move(now);
  }
  std::map<Index, Block> blocks;
  for (auto& [index, block] : blocks_) {
    block.box += growth.shift;
    for (Corner& corner : block.outline.corners) corner.p += shift;
    for (Edge& edge : block.outline.edges) edge.a += shift, edge.b += shift;
    for (Measured& m : block.cuts) {
      for (Vec* p : {&m.cut.a, &m.cut.b, &m.cut.first.p}) *p += shift;
      if (m.cut.to_corner) m.cut.second.p += shift;
      for (cv::Rect* box : {&m.reads.open, &m.reads.clearance, &m.reads.solid}) *box += growth.shift;
    }
    blocks.emplace(moved(index), std::move(block));
  }
  blocks_ = std::move(blocks);
}

/// Blocks that a box reaches into, by rising index.
template <class Visit>
void OpeningMap::each_near(const cv::Rect& box, Visit visit) {
  const auto index_of = [](int cell) { return cvFloor(static_cast<double>(cell) / kPlanBlock); };
  for (int column = index_of(box.x); column * kPlanBlock < box.br().x; ++column) {
    const int first = index_of(box.y);
    for (auto block = blocks_.lower_bound({column, first}); block != blocks_.end() && block->first.first == column; ++block) {
      if (block->first.second * kPlanBlock >= box.br().y) break;
      visit(block->first, block->second);
    }
  }
}

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

void OpeningMap::recollect(const Floor& floor, const Boxes& changed) {
  const double reach = max_width_m_ / floor.resolution_m, shortest = kNarrowest_m / floor.resolution_m;
  for (const Index& index : with_news_) blocks_.at(index).news.clear();
  with_news_.clear();
  if (changed.empty()) return;
  const int margin = static_cast<int>(reach) + 2;
  each_near(grown(bounds(changed), margin), [&](const Index& index, Block& block) {
    if (!meet(changed, grown(block.box, margin))) return;
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
          const Vec foot = corner.p + on_lattice(edge.a - corner.p + share * d);
          if (const double length = length_of(foot); fits(length) && is_in(other->box, foot)) to_edges.push_back({length, foot, nullptr, &edge});
        }
      }
      keep_shortest(floor, corner, to_corners, cuts);
      keep_shortest(floor, corner, to_edges, cuts);
    }
    drop_twins(cuts, kTwins_m / floor.resolution_m);
    take_cuts(index, block, cuts);
  });
}

/// Cuts that were there keep what was measured of them. Both lists are in order.
void OpeningMap::take_cuts(const Index& index, Block& block, const std::vector<FloorCut>& cuts) {
  Boxes& news = block.news;
  std::vector<Measured> now(cuts.size());
  auto before = block.cuts.begin();
  const auto gone_before = [&](const auto& order) {
    for (; before != block.cuts.end() && order_of(before->cut) < order; ++before) news.push_back(box_of(before->cut));
  };
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    gone_before(order_of(cuts[k]));
    const bool stays = before != block.cuts.end() && same(before->cut, cuts[k]);
    if (stays) now[k] = *before++;
    else now[k].cut = cuts[k], news.push_back(box_of(cuts[k]));
  }
  for (; before != block.cuts.end(); ++before) news.push_back(box_of(before->cut));
  block.cuts = std::move(now);
  if (news.empty()) return;
  with_news_.insert(index);
  untold_.insert(index);
}

double OpeningMap::narrowest_near(const Index& index, const FloorCut& cut, double cell_m) const {
  double narrowest = cut.length();
  for (const Block* other : around(index))
    for (const Measured& near : other->cuts) {
      if (near.cut.length() >= narrowest) break;  // shortest first
      if ((near.cut.centre() - cut.centre()).norm() < nearby(cut, cell_m)) narrowest = near.cut.length();
    }
  return narrowest;
}

/// Measures anew what was read where something changed, and of the rest the walls where they changed.
void OpeningMap::measure(const Index& index, const CutFeatures& features, double cell_m, const News& news) {
  Block& block = blocks_.at(index);
  Boxes cuts;
  for (const Block* other : around(index)) cuts.insert(cuts.end(), other->news.begin(), other->news.end());
  const auto is_stale = [&](const Measured& m) {
    if (!m.known || meet(news.open, m.reads.open) || meet(news.clearance, m.reads.clearance) || meet(news.solid, m.reads.solid)) return true;
    return meet(cuts, grown(box_of(m.cut), static_cast<int>(nearby(m.cut, cell_m)) + 1));
  };
  for (Measured& m : block.cuts) {
    bool changes = is_stale(m);
    if (changes) {
      m.opening = features.measure(m.cut, narrowest_near(index, m.cut, cell_m), m.reads);
      m.known = true;
    } else if (meet(news.walls, grown(box_of(m.cut.a, m.cut.a), kAtWall)) || meet(news.walls, grown(box_of(m.cut.b, m.cut.b), kAtWall))) {
      changes = features.measure_walls(m.opening);
    }
    if (changes) m.opening.probability = model_.probability(m.opening.features.data());
    if (changes) untold_.insert(index);
  }
}

void OpeningMap::update(const Floor& floor, const KnownSpace& space, const WallSet& walls, const FloorChange& change, const Boxes& walls_changed) {
  if (floor.open.empty()) return;
  // The large boxes first: who asks whether any is near needs no more.
  Boxes corners = change.open;
  const Boxes outline = retrace(floor, change.open);
  corners.insert(corners.end(), outline.begin(), outline.end());
  recollect(floor, corners);

  const News news{change.open, change.clearance, change.solid, walls_changed};
  const News all{{bounds(news.open)}, {bounds(news.clearance)}, {bounds(news.solid)}, {bounds(news.walls)}};
  const CutFeatures features(floor, space, walls);
  const int reach = static_cast<int>(max_width_m_ / floor.resolution_m) + 2;
  const int look = reach + static_cast<int>(std::max(kFarthestLook_m, 4 * max_width_m_) / floor.resolution_m) + 2;
  std::set<Index> beside_news;
  cv::Rect reached;
  for (const Index& index : with_news_) {
    for (int k = 0; k < 9; ++k) beside_news.insert({index.first + k % 3 - 1, index.second + k / 3 - 1});
    reached |= grown(blocks_.at(index).box, kPlanBlock);
  }
  for (const Boxes* boxes : {&all.open, &all.clearance, &all.solid, &all.walls})
    if (boxes->front().area() > 0) reached |= grown(boxes->front(), look);
  each_near(reached, [&](const Index& index, const Block& block) {
    bool any = beside_news.count(index) > 0;
    News here;
    for (const auto& [kind, far] : {std::pair(&News::open, look), std::pair(&News::clearance, look), std::pair(&News::solid, 2 * reach), std::pair(&News::walls, 2 * reach)}) {
      const cv::Rect window = grown(block.box, far) & cv::Rect({0, 0}, floor.open.size());
      if (meet(all.*kind, window)) here.*kind = those_near(news.*kind, window);
      any = any || !(here.*kind).empty();
    }
    if (any) measure(index, features, space.resolution_m, here);
  });
}

GapNews OpeningMap::take_news(const CutLimits& limits) {
  GapNews news;
  const auto order = [](const Gap& p, const Gap& q) { return p.order() < q.order(); };
  for (const Index& index : std::exchange(untold_, {})) {
    Block& block = blocks_.at(index);
    std::vector<Gap> now;
    for (const Measured& m : block.cuts)
      if (limits.take(m.opening)) now.push_back(m.opening);
    std::sort(now.begin(), now.end(), order);
    std::set_difference(block.gaps.begin(), block.gaps.end(), now.begin(), now.end(), std::back_inserter(news.gone), order);
    std::set_difference(now.begin(), now.end(), block.gaps.begin(), block.gaps.end(), std::back_inserter(news.come), order);
    block.gaps = std::move(now);
  }
  return news;
}

std::vector<Opening> OpeningMap::all() const {
  std::vector<Opening> out;
  for (const auto& [index, block] : blocks_)
    for (const Measured& m : block.cuts) out.push_back(m.opening);
  std::sort(out.begin(), out.end(), [](const Opening& p, const Opening& q) { return p.order() < q.order(); });
  return out;
}

std::vector<Opening> find_openings(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, double max_width_m,
                                   const OpeningModel& model) {
  OpeningMap map(max_width_m, model);
  FloorChange all;
  all.open = {cv::Rect({0, 0}, floor.open.size())};
  const WallSet set(walls);
  map.update(floor, space, set, all, {});
  return map.all();
}

}  // namespace modslam
