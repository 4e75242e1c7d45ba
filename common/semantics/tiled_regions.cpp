// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/tiled_regions.hpp"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <set>

namespace modslam {

void TiledRegions::label(int tile, const cv::Mat1b& mask) {
  Tile& t = tiles_[static_cast<std::size_t>(tile)];
  const cv::Rect box = tile_box(tile);
  cv::Mat1i labels, statistics;
  cv::Mat1d centres;
  const int count = cv::connectedComponentsWithStats(mask(box), labels, statistics, centres, 4, CV_32S);
  labels.copyTo(local_(box));
  t.stamp = round_;
  t.cells.clear();
  t.boxes.clear();
  for (int k = 1; k < count; ++k) {
    t.cells.push_back(statistics(k, cv::CC_STAT_AREA));
    t.boxes.push_back(cv::Rect(statistics(k, cv::CC_STAT_LEFT), statistics(k, cv::CC_STAT_TOP), statistics(k, cv::CC_STAT_WIDTH), statistics(k, cv::CC_STAT_HEIGHT)) +
                      box.tl());
  }
}

void TiledRegions::link(int tile) {
  Tile& t = tiles_[static_cast<std::size_t>(tile)];
  const cv::Rect box = tile_box(tile);
  const auto meetings = [&](const cv::Point& from, const cv::Point& step, int count, const cv::Point& across) {
    std::vector<std::pair<int, int>> out;
    for (int k = 0; k < count; ++k) {
      const cv::Point c = from + k * step;
      const std::pair<int, int> both(local_(c), local_(c + across));
      if (both.first && both.second && (out.empty() || out.back() != both)) out.push_back(both);
    }
    return out;
  };
  t.right.clear();
  t.below.clear();
  if (box.br().x < local_.cols) t.right = meetings({box.br().x - 1, box.y}, {0, 1}, box.height, {1, 0});
  if (box.br().y < local_.rows) t.below = meetings({box.x, box.br().y - 1}, {1, 0}, box.width, {0, 1});
}

void TiledRegions::join() {
  int pieces = 0;
  for (Tile& tile : tiles_) {
    tile.first = pieces;
    pieces += static_cast<int>(tile.cells.size());
  }
  std::vector<int> parent(static_cast<std::size_t>(pieces));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int k) {
    while (parent[static_cast<std::size_t>(k)] != k) k = parent[static_cast<std::size_t>(k)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(k)])];
    return k;
  };
  const auto unite = [&](const Tile& p, const Tile& q, const std::vector<std::pair<int, int>>& meetings) {
    for (const auto& [a, b] : meetings) {
      const int x = root(p.first + a - 1), y = root(q.first + b - 1);
      parent[static_cast<std::size_t>(std::max(x, y))] = std::min(x, y);
    }
  };
  for (std::size_t k = 0; k < tiles_.size(); ++k) {
    if (!tiles_[k].right.empty()) unite(tiles_[k], tiles_[k + 1], tiles_[k].right);
    if (!tiles_[k].below.empty()) unite(tiles_[k], tiles_[k + static_cast<std::size_t>(columns_)], tiles_[k].below);
  }
  numbers_.assign(static_cast<std::size_t>(pieces), 0);
  regions_.clear();
  for (std::size_t k = 0; k < tiles_.size(); ++k)
    for (std::size_t piece = 0; piece < tiles_[k].cells.size(); ++piece) {
      const int here = tiles_[k].first + static_cast<int>(piece), top = root(here);
      if (top == here) {
        regions_.emplace_back();
        numbers_[static_cast<std::size_t>(here)] = static_cast<int>(regions_.size());
      }
      const int number = numbers_[static_cast<std::size_t>(here)] = numbers_[static_cast<std::size_t>(top)];
      Region& region = regions_[static_cast<std::size_t>(number - 1)];
      region.members.push_back({static_cast<int>(k), static_cast<int>(piece) + 1, tiles_[k].stamp});
      region.cells += tiles_[k].cells[piece];
      region.box |= tiles_[k].boxes[piece];
    }
}

void TiledRegions::update(const cv::Mat1b& mask, const Boxes& changed) {
  ++round_;
  if (local_.size() != mask.size()) {
    local_ = cv::Mat1i(mask.size(), 0);
    columns_ = (mask.cols + kTile - 1) / kTile;
    tiles_.assign(static_cast<std::size_t>(columns_ * ((mask.rows + kTile - 1) / kTile)), {});
  }
  std::set<int> relabel, relink;
  for (const cv::Rect& box : changed)
    for (int row = box.y / kTile; row * kTile < box.br().y; ++row)
      for (int column = box.x / kTile; column * kTile < box.br().x; ++column) {
        const int tile = row * columns_ + column;
        relabel.insert(tile);
        relink.insert(tile);
        if (column > 0) relink.insert(tile - 1);
        if (row > 0) relink.insert(tile - columns_);
      }
  for (const int tile : relabel) label(tile, mask);
  for (const int tile : relink) link(tile);
  join();
}

std::vector<int> TiledRegions::numbers_in(int tile) const {
  const Tile& t = tiles_[static_cast<std::size_t>(tile)];
  const auto first = numbers_.begin() + t.first;
  return {first, first + static_cast<std::ptrdiff_t>(t.cells.size())};
}

cv::Mat1b TiledRegions::mask_of(int region, const cv::Rect& box) const {
  cv::Mat1b mask(box.size(), std::uint8_t{0});
  for (const Region::Member& member : regions_[static_cast<std::size_t>(region - 1)].members) {
    const cv::Rect part = tile_box(member.tile) & box;
    if (part.area() == 0) continue;
    cv::Mat1b here;
    cv::inRange(local_(part), member.local, member.local, here);
    cv::Mat1b target = mask(part - box.tl());
    cv::bitwise_or(target, here, target);
  }
  return mask;
}

}  // namespace modslam
