// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/wall_map.hpp"

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kPlanCell_m = 0.05;
constexpr double kAround_m = 0.3;  // what says whether a wall is solid lies this near

cv::Rect block_box(const WallBlocks::Index& index) {
  const Eigen::Vector2d half(0.5 * WallBlocks::kBlock_m, 0.5 * WallBlocks::kBlock_m);
  return plan_box(WallBlocks::centre(index) - half, WallBlocks::centre(index) + half, 0);
}

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

void WallMap::find_bands(const Index& index) {
  std::vector<Band> bands;
  const auto block = blocks_.blocks().find(index);
  if (block != blocks_.blocks().end())
    for (const auto& [key, sums] : block->second)
      if (sums.n > 0) bands.emplace_back(index, key, sums);
  bands_[index] = joined(std::move(bands), options_);
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

std::vector<std::vector<WallMap::Member>> WallMap::chains() const {
  std::map<Index, std::size_t> first;
  std::vector<Member> members;
  for (const auto& [index, bands] : bands_) {
    first[index] = members.size();
    for (std::size_t k = 0; k < bands.size(); ++k) members.emplace_back(index, static_cast<int>(k));
  }
  std::vector<std::size_t> parent(members.size());
  for (std::size_t k = 0; k < parent.size(); ++k) parent[k] = k;
  const auto root = [&](std::size_t k) {
    while (parent[k] != k) k = parent[k] = parent[parent[k]];
    return k;
  };
  const auto number = [&](const Member& member) { return first.at(member.first) + static_cast<std::size_t>(member.second); };
  for (const auto& [index, links] : links_)
    for (const auto& [p, q] : links) {
      const std::size_t a = root(number(p)), b = root(number(q));
      parent[std::max(a, b)] = std::min(a, b);  // the root is the first member
    }
  std::vector<std::vector<Member>> out;
  std::vector<std::size_t> chain_of(members.size());
  for (std::size_t k = 0; k < members.size(); ++k) {
    if (root(k) == k) {
      chain_of[k] = out.size();
      out.emplace_back();
    }
    out[chain_of[root(k)]].push_back(members[k]);
  }
  return out;
}

std::vector<WallBand> WallMap::walls_of(const std::vector<Member>& chain, const IsSolid& is_solid, const Finish& finish) {
  std::vector<Band> bands;
  for (const Member& member : chain) bands.push_back(band(member));
  std::vector<WallBand> out;
  for (const Band& one : joined(std::move(bands), options_)) {
    WallBand walls = one.walls(options_, is_solid);
    for (Wall& wall : walls.walls) {
      const double sigma_m = wall.sigma_m;
      wall = finished_.ask({wall.a.x(), wall.a.y(), wall.b.x(), wall.b.y()}, plan_box(wall.a, wall.b, kAround_m), [&] {
        finish(wall);
        return wall;
      });
      wall.sigma_m = sigma_m;
    }
    if (!walls.walls.empty()) out.push_back(std::move(walls));
  }
  return out;
}

std::vector<WallBand> WallMap::update(const IsSolid& is_solid, const Finish& finish, const Boxes& changed) {
  Boxes stirred = changed;
  std::set<Index> relink;
  for (const Index& index : blocks_.take_changed()) {
    find_bands(index);
    stirred.push_back(block_box(index));
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(-1, 0), std::pair(0, -1), std::pair(-1, -1), std::pair(1, -1)})
      relink.insert({index.first + dx, index.second + dy});
  }
  for (const Index& index : relink) find_links(index);
  walls_.forget(stirred);
  finished_.forget(stirred);
  std::vector<WallBand> out;
  for (const std::vector<Member>& chain : chains()) {
    Eigen::Vector2d low(1e300, 1e300), high(-1e300, -1e300);
    cv::Rect from;
    for (const Member& member : chain) {
      const Eigen::Vector2d a = band(member).low_end(), b = band(member).high_end();
      low = low.cwiseMin(a).cwiseMin(b);
      high = high.cwiseMax(a).cwiseMax(b);
      from |= block_box(member.first);
    }
    const auto& walls = walls_.ask(chain, from | plan_box(low, high, kAround_m), [&] { return walls_of(chain, is_solid, finish); });
    out.insert(out.end(), walls.begin(), walls.end());
  }
  return out;
}

std::vector<WallBand> merge_segments(const std::vector<PlacedSegments>& scans, const WallMapOptions& options, const WallMap::IsSolid& is_solid) {
  WallMap map(options);
  for (const PlacedSegments& scan : scans)
    for (const Segment& segment : scan) map.add(segment, 1);
  return map.update(is_solid, [](Wall&) {}, {});
}

}  // namespace modslam
