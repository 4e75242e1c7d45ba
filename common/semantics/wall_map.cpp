// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_map.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace modslam {
namespace {

constexpr double kPlanCell_m = 0.05;
constexpr double kAround_m = 0.3;  // what says whether a wall is solid lies this near

std::array<double, 4> ends_of(const Wall& wall) { return {wall.a.x(), wall.a.y(), wall.b.x(), wall.b.y()}; }

/// Heaviest first, each takes what fits of the rest, until none fits any more.
std::vector<Band> joined(std::vector<Band> bands, const WallMapOptions& options) {
  std::stable_sort(bands.begin(), bands.end(), [](const Band& p, const Band& q) { return p.points() > q.points(); });
  for (std::size_t i = 0; i < bands.size(); ++i)
    for (std::size_t j = i + 1; j < bands.size();) {
      if (!bands[i].takes(bands[j], options)) {
        ++j;
        continue;
      }
      bands[i].absorb(bands[j]);
      bands.erase(bands.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // the longer band may reach others now
    }
  return bands;
}

}  // namespace

cv::Rect plan_box(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m) {
  const Eigen::Vector2d low = p.cwiseMin(q).array() - margin_m, high = p.cwiseMax(q).array() + margin_m;
  const auto down = [](double x) { return static_cast<int>(std::floor(x / kPlanCell_m)); };
  return {cv::Point(down(low.x()), down(low.y())), cv::Point(down(high.x()) + 1, down(high.y()) + 1)};
}

void WallMap::find_bands(const Index& index, std::set<Member>& fresh) {
  std::vector<Band> bands;
  const auto block = blocks_.blocks().find(index);
  if (block != blocks_.blocks().end())
    for (const auto& [key, sums] : block->second)
      if (sums.n > 0) bands.emplace_back(index, key, sums);
  bands = joined(std::move(bands), options_);
  std::vector<Band>& known = bands_[index];
  for (std::size_t k = 0; k < bands.size(); ++k)
    if (k >= known.size() || !(bands[k] == known[k])) fresh.emplace(index, static_cast<int>(k));
  known = std::move(bands);
}

void WallMap::find_links(const Index& index) {
  Links& links = links_[index];
  links.clear();
  const auto here = bands_.find(index);
  if (here == bands_.end()) return;
  for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1), std::pair(-1, 1)}) {
    const Index next(index.first + dx, index.second + dy);
    const auto there = bands_.find(next);
    if (there == bands_.end()) continue;
    for (std::size_t i = 0; i < here->second.size(); ++i)
      for (std::size_t j = 0; j < there->second.size(); ++j) {
        const Band &p = here->second[i], &q = there->second[j];
        const bool first_is_longer = p.length_m() >= q.length_m();
        if ((first_is_longer ? p : q).takes(first_is_longer ? q : p, options_)) links.push_back({{index, static_cast<int>(i)}, {next, static_cast<int>(j)}});
      }
  }
}

/// Takes the chains that run through any of the blocks apart. @return all their bands, and all bands of these blocks.
std::vector<WallMap::Member> WallMap::dissolve(const std::set<Index>& blocks, std::vector<Chain>& dissolved) {
  std::set<Member> firsts;
  for (const Index& index : blocks)
    if (const auto here = through_.find(index); here != through_.end()) firsts.insert(here->second.begin(), here->second.end());
  std::vector<Member> loose;
  for (const Member& first : firsts) {
    Chain& chain = chains_.at(first);
    for (const Member& member : chain.members) {
      through_[member.first].erase(first);
      if (!blocks.count(member.first)) loose.push_back(member);
    }
    dissolved.push_back(std::move(chain));
    chains_.erase(first);
  }
  for (const Index& index : blocks) {
    const auto here = bands_.find(index);
    for (std::size_t k = 0; here != bands_.end() && k < here->second.size(); ++k) loose.emplace_back(index, static_cast<int>(k));
  }
  std::sort(loose.begin(), loose.end());
  return loose;
}

/// Bands that are linked, in order; each chain begins with its first.
std::vector<std::vector<WallMap::Member>> WallMap::chains_of(const std::vector<Member>& loose) const {
  std::vector<std::size_t> parent(loose.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t k) {
    while (parent[k] != k) k = parent[k] = parent[parent[k]];
    return k;
  };
  const auto number = [&](const Member& member) { return static_cast<std::size_t>(std::lower_bound(loose.begin(), loose.end(), member) - loose.begin()); };
  for (std::size_t k = 0; k < loose.size(); ++k) {
    if (k > 0 && loose[k].first == loose[k - 1].first) continue;
    const auto links = links_.find(loose[k].first);
    if (links == links_.end()) continue;
    for (const auto& [p, q] : links->second) {
      const std::size_t i = number(p), j = number(q);
      if (i >= loose.size() || j >= loose.size() || loose[i] != p || loose[j] != q) continue;
      const std::size_t a = root(i), b = root(j);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<std::size_t, std::vector<Member>> chains;
  for (std::size_t k = 0; k < loose.size(); ++k) chains[root(k)].push_back(loose[k]);
  std::vector<std::vector<Member>> out;
  for (auto& [first, members] : chains) out.push_back(std::move(members));
  return out;
}

cv::Rect WallMap::surroundings(const std::vector<Member>& members) const {
  Eigen::Vector2d low(1e300, 1e300), high(-1e300, -1e300);
  for (const Member& member : members) {
    const Eigen::Vector2d a = band(member).low_end(), b = band(member).high_end();
    low = low.cwiseMin(a).cwiseMin(b);
    high = high.cwiseMax(a).cwiseMax(b);
  }
  return plan_box(low, high, kAround_m);
}

void WallMap::find_walls(Chain& chain, const IsSolid& is_solid, const Finish& finish, const KnownWalls& known) const {
  std::vector<Band> bands;
  for (const Member& member : chain.members) bands.push_back(band(member));
  chain.bands.clear();
  for (const Band& one : joined(std::move(bands), options_)) {
    WallBand walls = one.walls(options_, is_solid);
    for (Wall& wall : walls.walls) {
      if (const auto same = known.find(ends_of(wall)); same != known.end()) {
        wall.evidence = same->second.evidence;
        wall.on_object = same->second.on_object;
      } else {
        finish(wall);
      }
    }
    if (!walls.walls.empty()) chain.bands.push_back(std::move(walls));
  }
}

std::vector<const WallBand*> WallMap::update(const IsSolid& is_solid, const Finish& finish, const Boxes& changed) {
  const std::set<Index> news = blocks_.take_changed();
  std::set<Index> relink, around;
  std::set<Member> fresh;
  for (const Index& index : news) {
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(-1, 0), std::pair(0, -1), std::pair(-1, -1), std::pair(1, -1)})
      relink.insert({index.first + dx, index.second + dy});
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) around.insert({index.first + dx, index.second + dy});
  }
  for (const Index& index : news) find_bands(index, fresh);
  for (const Index& index : relink) find_links(index);

  const cv::Rect all = bounds(changed);
  const auto is_stirred = [&](const cv::Rect& from) { return meet(all, from) && meet(changed, from); };
  const auto is_fresh = [&](const Member& member) { return fresh.count(member) > 0; };
  KnownWalls known;
  const auto keep = [&](const Chain& chain) {
    for (const WallBand& one : chain.bands)
      for (const Wall& wall : one.walls)
        if (!meet(changed, plan_box(wall.a, wall.b, kAround_m))) known.emplace(ends_of(wall), wall);
  };
  std::vector<Chain> dissolved;
  const std::vector<Member> loose = dissolve(around, dissolved);
  std::vector<Chain*> stale;
  for (const Chain& chain : dissolved) keep(chain);
  auto gone = dissolved.begin();  // both in order
  entries_.erase(std::remove_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    while (gone != dissolved.end() && gone->members.front() < entry.first) ++gone;
    return gone != dissolved.end() && gone->members.front() == entry.first;
  }), entries_.end());
  for (const Entry& entry : entries_)
    if (is_stirred(entry.from)) {
      keep(*entry.chain);
      stale.push_back(entry.chain);
    }
  const auto n_stay = static_cast<std::ptrdiff_t>(entries_.size());
  for (std::vector<Member>& members : chains_of(loose)) {
    const Member first = members.front();
    for (const Member& member : members) through_[member.first].insert(first);
    Chain& chain = chains_[first];
    chain.from = surroundings(members);
    chain.members = std::move(members);
    entries_.push_back({first, chain.from, &chain});
    const auto same = std::find_if(dissolved.begin(), dissolved.end(), [&](const Chain& old) { return old.members == chain.members && old.from == chain.from; });
    const bool stays = same != dissolved.end() && !is_stirred(chain.from) && std::none_of(chain.members.begin(), chain.members.end(), is_fresh);
    if (stays) chain.bands = std::move(same->bands);
    else stale.push_back(&chain);
  }
  std::inplace_merge(entries_.begin(), entries_.begin() + n_stay, entries_.end(), [](const Entry& p, const Entry& q) { return p.first < q.first; });
  for (Chain* chain : stale) find_walls(*chain, is_solid, finish, known);
  std::vector<const WallBand*> out;
  for (const Entry& entry : entries_)
    for (const WallBand& one : entry.chain->bands) out.push_back(&one);
  return out;
}

std::vector<WallBand> merge_segments(const std::vector<PlacedSegments>& scans, const WallMapOptions& options, const WallMap::IsSolid& is_solid) {
  WallMap map(options);
  for (const PlacedSegments& scan : scans)
    for (const Segment& segment : scan) map.add(segment, 1);
  std::vector<WallBand> out;
  for (const WallBand* band : map.update(is_solid, [](Wall&) {}, {})) out.push_back(*band);
  return out;
}

}  // namespace modslam
