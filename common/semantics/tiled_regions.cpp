// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/tiled_regions.hpp"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <set>

namespace modslam {

namespace {

/// Cells of a tile's row that are set, side by side.
struct Run {
  int y, begin, end;
  std::size_t parent;  ///< an earlier run of the same piece, or itself
};

/// The runs of a tile, row by row; those that touch over their sides hang together.
class Runs {
 public:
  explicit Runs(const cv::Mat1b& tile) {
    std::size_t above = 0, here = 0;  // where the runs of the row before begin, and those of this one
    for (int y = 0; y < tile.rows; ++y, above = here, here = runs_.size()) {
      const std::uint8_t *row = tile[y], *end = row + tile.cols;
      for (const std::uint8_t* at = row; (at = find_cell(at, end, 255)) != end;) {
        const std::uint8_t* stop = find_cell(at, end, 0);
        runs_.push_back({y, static_cast<int>(at - row), static_cast<int>(stop - row), runs_.size()});
        for (std::size_t k = above; k < here && runs_[k].begin < runs_.back().end; ++k)
          if (runs_[k].end > runs_.back().begin) join(k, runs_.size() - 1);
        at = stop;
      }
    }
  }

  const std::vector<Run>& runs() const { return runs_; }
  std::size_t root(std::size_t k) const {
    while (runs_[k].parent != k) k = runs_[k].parent;
    return k;
  }

 private:
  void join(std::size_t p, std::size_t q) {
    const std::size_t a = root(p), b = root(q);
    runs_[std::max(a, b)].parent = std::min(a, b);
  }
  std::vector<Run> runs_;
};

}  // namespace

/// Pieces are numbered in the order of their first cells, row by row.
void TiledRegions::label(int tile, const cv::Mat1b& mask) {
  Tile& t = tiles_[static_cast<std::size_t>(tile)];
  const cv::Rect box = tile_box(tile);
  cv::Mat1w labels = local_(box);
  labels.setTo(0);
  t.stamp = round_;
  t.cells.clear();
  t.boxes.clear();
  const Runs found(mask(box));
  const std::vector<Run>& runs = found.runs();
  std::vector<std::uint16_t> piece(runs.size());
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const std::size_t root = found.root(k);
    if (root == k) {
      t.cells.push_back(0);
      t.boxes.emplace_back();
      piece[k] = static_cast<std::uint16_t>(t.cells.size());
    }
    piece[k] = piece[root];
    const Run& run = runs[k];
    std::fill(labels[run.y] + run.begin, labels[run.y] + run.end, piece[k]);
    t.cells[piece[k] - 1U] += run.end - run.begin;
    t.boxes[piece[k] - 1U] |= cv::Rect(box.x + run.begin, box.y + run.y, run.end - run.begin, 1);
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
    local_ = cv::Mat1w(mask.size(), std::uint16_t{0});
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

void TiledRegions::numbers_in(int tile, std::vector<int>& numbers) const {
  const Tile& t = tiles_[static_cast<std::size_t>(tile)];
  const auto first = numbers_.begin() + t.first;
  numbers.assign(first, first + static_cast<std::ptrdiff_t>(t.cells.size()));
}

cv::Mat1b TiledRegions::mask_of(const Region& region, const cv::Rect& box) const {
  cv::Mat1b mask(box.size(), std::uint8_t{0});
  for (const Region::Member& member : region.members) {
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
