// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_map.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/graph/disjoint_sets.hpp"

namespace modslam {
namespace {

constexpr double kPlanCell_m = 0.05;
constexpr double kAround_m = 0.3;  // what says whether a wall is solid lies this near

std::array<double, 4> ends_of(const Wall& wall) { return {wall.a.x(), wall.a.y(), wall.b.x(), wall.b.y()}; }

/// Whether a box of plan cells reaches to what says whether the line is solid: by the axes of the box and by the line's normal.
bool is_beside(const cv::Rect& box, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  if (!meet(plan_box(a, b, kAround_m), box)) return false;
  const Eigen::Vector2d middle = kPlanCell_m * (Eigen::Vector2d(box.x, box.y) + 0.5 * Eigen::Vector2d(box.width, box.height)) - a;
  const Eigen::Vector2d half = 0.5 * kPlanCell_m * Eigen::Vector2d(box.width, box.height), d = (b - a).normalized();
  return std::abs(d.x() * middle.y() - d.y() * middle.x()) <= std::abs(d.y()) * half.x() + std::abs(d.x()) * half.y() + kAround_m + kPlanCell_m;
}

/// Heaviest first, each takes what fits of the rest, until none fits any more.
std::vector<Band> joined(std::vector<Band> bands, const WallMapOptions& options) {
  std::stable_sort(bands.begin(), bands.end(), [](const Band& p, const Band& q) { return p.points() > q.points(); });
  std::vector<Band> out;
  std::vector<std::size_t> left(bands.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  while (!left.empty()) {
    Band& band = bands[left.front()];
    left.erase(left.begin());
    const auto next = [&] { return std::find_if(left.begin(), left.end(), [&](std::size_t k) { return band.takes(bands[k], options); }); };
    for (auto taken = next(); taken != left.end(); taken = next()) {  // the longer band may reach others each time
      band.absorb(bands[*taken]);
      left.erase(taken);
    }
    out.push_back(std::move(band));
  }
  return out;
}

}  // namespace

cv::Rect plan_box(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m) {
  const Eigen::Vector2d low = p.cwiseMin(q).array() - margin_m, high = p.cwiseMax(q).array() + margin_m;
  const auto down = [](double x) { return static_cast<int>(std::floor(x / kPlanCell_m)); };
  return {cv::Point(down(low.x()), down(low.y())), cv::Point(down(high.x()) + 1, down(high.y()) + 1)};
}

/// @param fresh  takes the bands that are not what they were. @return whether they are as many.
bool WallMap::find_bands(const Index& index, std::set<Member>& fresh) {
  std::vector<Band> bands;
  const auto block = blocks_.blocks().find(index);
  if (block != blocks_.blocks().end())
    for (const auto& [key, sums] : block->second)
      if (sums.n > 0) bands.emplace_back(index, key, sums);
  bands = joined(std::move(bands), options_);
  std::vector<Band>& known = bands_[index];
  for (std::size_t k = 0; k < bands.size(); ++k)
    if (k >= known.size() || !(bands[k] == known[k])) fresh.emplace(index, static_cast<int>(k));
  const bool as_many = bands.size() == known.size();
  known = std::move(bands);
  return as_many;
}

WallMap::Links WallMap::links_of(const Index& index) const {
  Links links;
  const auto here = bands_.find(index);
  if (here == bands_.end()) return links;
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
  return links;
}

/// @param relinked  takes blocks that links come or go between.
void WallMap::find_links(const Index& index, std::set<Index>& relinked) {
  Links links = links_of(index);
  Links& known = links_[index];
  if (links == known) return;
  relinked.insert(index);
  for (const Links* those : {&links, &known})
    for (const auto& [from, to] : *those) relinked.insert(to.first);
  known = std::move(links);
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
  DisjointSets sets(loose.size());
  const auto number = [&](const Member& member) { return static_cast<std::size_t>(std::lower_bound(loose.begin(), loose.end(), member) - loose.begin()); };
  for (std::size_t k = 0; k < loose.size(); ++k) {
    if (k > 0 && loose[k].first == loose[k - 1].first) continue;
    const auto links = links_.find(loose[k].first);
    if (links == links_.end()) continue;
    for (const auto& [p, q] : links->second) {
      const std::size_t i = number(p), j = number(q);
      if (i < loose.size() && j < loose.size() && loose[i] == p && loose[j] == q) sets.join_lowest(i, j);
    }
  }
  std::map<std::size_t, std::vector<Member>> chains;
  for (std::size_t k = 0; k < loose.size(); ++k) chains[sets.root(k)].push_back(loose[k]);
  std::vector<std::vector<Member>> out;
  for (auto& [first, members] : chains) out.push_back(std::move(members));
  return out;
}

/// @return first members of chains whose lines are not known.
std::set<WallMap::Member> WallMap::rechain(const std::set<Index>& blocks, const std::set<Member>& fresh, Numbers& gone) {
  std::vector<Chain> dissolved;
  const std::vector<Member> loose = dissolve(blocks, dissolved);
  std::set<Member> stale;
  for (std::vector<Member>& members : chains_of(loose)) {
    const Member first = members.front();
    for (const Member& member : members) through_[member.first].insert(first);
    Chain& chain = chains_[first];
    chain.members = std::move(members);
    const auto same = std::find_if(dissolved.begin(), dissolved.end(), [&](const Chain& old) { return old.members == chain.members; });
    if (same == dissolved.end()) stale.insert(first);
    else chain.lines = std::exchange(same->lines, {});
  }
  for (const Chain& chain : dissolved) gone.insert(gone.end(), chain.lines.begin(), chain.lines.end());
  for (const Member& member : fresh)
    for (const Member& first : through_.at(member.first)) {
      const std::vector<Member>& members = chains_.at(first).members;
      if (std::binary_search(members.begin(), members.end(), member)) stale.insert(first);
    }
  return stale;
}

/// Makes the chains' lines; those that come out as they were stay. @param gone  lines that are in no chain any more; takes others. @return new lines.
Numbers WallMap::join(const std::set<Member>& chains, Numbers& gone) {
  Numbers come;
  for (const Member& first : chains) {
    Numbers& lines = chains_.at(first).lines;
    gone.insert(gone.end(), lines.begin(), lines.end());
    lines.clear();
  }
  for (const Member& first : chains) {
    Chain& chain = chains_.at(first);
    Numbers& lines = chain.lines;
    std::vector<Band> bands;
    for (const Member& member : chain.members) bands.push_back(band(member));
    for (Band& one : joined(std::move(bands), options_)) {
      const auto same = std::find_if(gone.begin(), gone.end(), [&](std::size_t k) { return lines_[k].band == one; });
      if (same != gone.end()) {
        lines.push_back(*same);
        gone.erase(same);
        continue;
      }
      lines.push_back(lines_.take({one, {}, true}));
      line_index_.add_line(one.low_end(), one.high_end(), lines.back());
      come.push_back(lines.back());
    }
  }
  for (const std::size_t k : gone) {
    line_index_.remove_line(lines_[k].band.low_end(), lines_[k].band.high_end(), k);
    lines_[k].is_there = false;
    lines_.give_back(k);
  }
  return come;
}

Numbers WallMap::lines_near(const Boxes& changed) const {
  Numbers near;
  for (const cv::Rect& box : changed) {
    const Eigen::Vector2d low = kPlanCell_m * Eigen::Vector2d(box.x, box.y), high = kPlanCell_m * Eigen::Vector2d(box.br().x, box.br().y);
    line_index_.each_near(low, high, kAround_m + 2 * kPlanCell_m, [&](std::size_t k) {
      if (is_beside(box, lines_[k].band.low_end(), lines_[k].band.high_end())) near.push_back(k);
    });
  }
  return near;
}

/// Walls whose ends come out the same keep their numbers and, off the changes, what was found of them.
WallMap::News WallMap::read_walls(const Numbers& gone, const Numbers& stale, const IsSolid& is_solid, const Finish& finish, const Boxes& changed) {
  News news;
  const cv::Rect all = bounds(changed);
  const auto is_stirred = [&](const Wall& wall) {
    const auto is_near = [&](const cv::Rect& box) { return is_beside(box, wall.a, wall.b); };
    return is_near(all) && std::any_of(changed.begin(), changed.end(), is_near);
  };
  std::map<Ends, std::size_t> known;
  for (const Numbers* lines : {&gone, &stale})
    for (const std::size_t k : *lines)
      for (const std::size_t number : lines_[k].walls)
        if (!known.emplace(ends_of(walls_[number]), number).second) news.gone.push_back(number);
  for (const std::size_t k : stale) {
    Numbers& numbers = lines_[k].walls;
    numbers.clear();
    for (Wall& wall : lines_[k].band.walls(options_, is_solid).walls) {
      const auto same = known.find(ends_of(wall));
      if (same == known.end()) {
        finish(wall);
        numbers.push_back(walls_.take(wall));
        news.come.push_back(numbers.back());
        continue;
      }
      Wall& before = walls_[same->second];
      if (is_stirred(wall)) {
        finish(wall);
      } else {
        wall.evidence = before.evidence;
        wall.on_object = before.on_object;
      }
      news.altered.push_back(same->second);
      before = wall;
      numbers.push_back(same->second);
      known.erase(same);
    }
    beside_.resize(walls_.end());
    for (std::size_t i = 0; i < numbers.size(); ++i)
      beside_[numbers[i]] = {i == 0 ? kNone : numbers[i - 1], i + 1 == numbers.size() ? kNone : numbers[i + 1]};
  }
  for (const auto& [ends, number] : known) news.gone.push_back(number);
  for (const std::size_t number : news.gone) walls_.give_back(number);
  return news;
}

WallMap::News WallMap::update(const IsSolid& is_solid, const Finish& finish, const Boxes& changed) {
  walls_.next_round();
  lines_.next_round();
  const std::set<Index> news = blocks_.take_changed();
  std::set<Index> relink, relinked;
  for (const Index& index : news)
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(-1, 0), std::pair(0, -1), std::pair(-1, -1), std::pair(1, -1)})
      relink.insert({index.first + dx, index.second + dy});
  std::set<Member> fresh;
  for (const Index& index : news)
    if (!find_bands(index, fresh)) relinked.insert(index);
  for (const Index& index : relink) find_links(index, relinked);
  Numbers gone;
  Numbers stale = join(rechain(relinked, fresh, gone), gone);
  const Numbers near = lines_near(changed);
  stale.insert(stale.end(), near.begin(), near.end());
  tidy(stale);
  return read_walls(gone, stale, is_solid, finish, changed);
}

std::vector<WallBand> WallMap::bands() const {
  std::vector<WallBand> out;
  for (std::size_t k = 0; k < lines_.end(); ++k) {
    if (!lines_[k].is_there || lines_[k].walls.empty()) continue;
    out.emplace_back();
    for (const std::size_t number : lines_[k].walls) out.back().walls.push_back(walls_[number]);
  }
  return out;
}

std::vector<WallBand> merge_segments(const std::vector<PlacedSegments>& scans, const WallMapOptions& options, const WallMap::IsSolid& is_solid) {
  WallMap map(options);
  for (const PlacedSegments& scan : scans)
    for (const Segment& segment : scan) map.add(segment, 1);
  map.update(is_solid, [](Wall&) {}, {});
  return map.bands();
}

}  // namespace modslam
