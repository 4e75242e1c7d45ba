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

/// Pieces are numbered in the order of their first cells, row by row. Those that stayed as they were are known again. @return whether any did not.
bool TiledRegions::label(int tile, const cv::Mat1b& mask) {
  Tile& t = tiles_[static_cast<std::size_t>(tile)];
  const cv::Rect box = tile_box(tile);
  cv::Mat1w labels = local_(box);
  const cv::Mat1w labels_before = labels.clone();
  const std::vector<Piece> before = std::move(t.pieces);
  labels.setTo(0);
  t.pieces.clear();
  const Runs found(mask(box));
  const std::vector<Run>& runs = found.runs();
  std::vector<std::uint16_t> piece(runs.size()), was;  // was: the piece before that all cells of a piece were in
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Run& run = runs[k];
    const std::size_t root = found.root(k);
    const std::uint16_t *old = labels_before[run.y] + run.begin, *old_end = labels_before[run.y] + run.end;
    if (root == k) {
      t.pieces.emplace_back();
      was.push_back(*old);
      piece[k] = static_cast<std::uint16_t>(t.pieces.size());
    }
    piece[k] = piece[root];
    std::uint16_t& here = was[piece[k] - 1U];
    if (std::any_of(old, old_end, [&](std::uint16_t one) { return one != here; })) here = 0;
    std::fill(labels[run.y] + run.begin, labels[run.y] + run.end, piece[k]);
    t.pieces[piece[k] - 1U].cells += run.end - run.begin;
    t.pieces[piece[k] - 1U].box |= cv::Rect(box.x + run.begin, box.y + run.y, run.end - run.begin, 1);
  }
  bool all_stay = before.size() == was.size();
  for (std::size_t k = 0; k < was.size(); ++k) {
    const bool stays = was[k] > 0 && before[was[k] - 1U].cells == t.pieces[k].cells;
    if (stays) t.pieces[k].known = before[was[k] - 1U].known;
    all_stay = all_stay && stays && was[k] == k + 1;
  }
  return !all_stay;
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
    pieces += static_cast<int>(tile.pieces.size());
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
  region_of_.assign(static_cast<std::size_t>(pieces), 0);
  regions_.clear();
  for (const Tile& tile : tiles_)
    for (std::size_t piece = 0; piece < tile.pieces.size(); ++piece) {
      const int here = tile.first + static_cast<int>(piece), top = root(here);
      if (top == here) {
        regions_.emplace_back();
        region_of_[static_cast<std::size_t>(here)] = static_cast<int>(regions_.size());
      }
      const int region = region_of_[static_cast<std::size_t>(here)] = region_of_[static_cast<std::size_t>(top)];
      regions_[static_cast<std::size_t>(region - 1)].cells += tile.pieces[piece].cells;
      regions_[static_cast<std::size_t>(region - 1)].box |= tile.pieces[piece].box;
    }
}

/// A set is the same when all its pieces say that they were in one set, and that it had as many.
TiledRegions::SetNumbers TiledRegions::number_sets(const std::vector<int>& root_of, Kind kind) {
  struct Set {
    Known before;
    int pieces = 0;
    bool same = true;
  };
  std::vector<Set> sets(root_of.size());
  const auto root_at = [&](const Tile& tile, std::size_t k) { return static_cast<std::size_t>(root_of[static_cast<std::size_t>(region_of_[static_cast<std::size_t>(tile.first) + k])]); };
  for (const Tile& tile : tiles_)
    for (std::size_t k = 0; k < tile.pieces.size(); ++k) {
      Set& set = sets[root_at(tile, k)];
      const Known& known = tile.pieces[k].known[kind];
      if (set.pieces++ == 0) set.before = known;
      else set.same = set.same && known == set.before;
    }
  SetNumbers numbers{std::vector<int>(sets.size(), 0), {}};
  for (std::size_t k = 1; k < sets.size(); ++k) {
    Set& set = sets[k];
    if (set.pieces == 0) continue;
    set.same = set.same && set.before.number > 0 && set.before.pieces == set.pieces;
    numbers.of_root[k] = set.same ? set.before.number : ++last_number_[kind];
  }
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    Tile& tile = tiles_[t];
    bool is_new = tile.is_new;
    for (std::size_t k = 0; k < tile.pieces.size(); ++k) {
      const std::size_t root = root_at(tile, k);
      if (sets[root].same) continue;
      is_new = true;
      tile.pieces[k].known[kind] = {numbers.of_root[root], sets[root].pieces};
    }
    if (is_new) numbers.new_in.push_back(static_cast<int>(t));
  }
  return numbers;
}

/// By whole tiles.
void TiledRegions::grow(const Growth& growth) {
  for (const int tile : new_tiles_) tiles_[static_cast<std::size_t>(tile)].is_new = false;
  new_tiles_.clear();
  const int columns_before = columns_, rows = (growth.size.height + kTile - 1) / kTile;
  columns_ = columns_in(growth.size);
  std::vector<Tile> tiles(static_cast<std::size_t>(columns_ * rows));
  for (std::size_t k = 0; k < tiles_.size(); ++k) {
    const int row = static_cast<int>(k) / columns_before + growth.shift.y / kTile, column = static_cast<int>(k) % columns_before + growth.shift.x / kTile;
    Tile& tile = tiles[static_cast<std::size_t>(row * columns_ + column)] = std::move(tiles_[k]);
    for (Piece& piece : tile.pieces) piece.box += growth.shift;
  }
  tiles_ = std::move(tiles);
  local_ = grown(local_, growth, 0);
}

void TiledRegions::update(const cv::Mat1b& mask, const Boxes& changed) {
  for (const int tile : new_tiles_) tiles_[static_cast<std::size_t>(tile)].is_new = false;
  new_tiles_.clear();
  if (local_.size() != mask.size()) {
    local_ = cv::Mat1w(mask.size(), std::uint16_t{0});
    columns_ = columns_in(mask.size());
    tiles_.assign(static_cast<std::size_t>(columns_ * ((mask.rows + kTile - 1) / kTile)), {});
  }
  std::set<int> relabel, relink;
  for (const cv::Rect& box : changed)
    each_in(box, [&](int tile) {
      relabel.insert(tile);
      relink.insert(tile);
      if (tile % columns_ > 0) relink.insert(tile - 1);
      if (tile >= columns_) relink.insert(tile - columns_);
    });
  for (const int tile : relabel)
    if (label(tile, mask)) {
      tiles_[static_cast<std::size_t>(tile)].is_new = true;
      new_tiles_.push_back(tile);
    }
  for (const int tile : relink) link(tile);
  join();
}

cv::Mat1b TiledRegions::mask_of(const std::vector<int>& root_of, int root, const cv::Rect& box) const {
  cv::Mat1b mask(box.size(), std::uint8_t{0}), here;
  each_in(box, [&](int tile) {
    const cv::Rect part = tile_box(tile) & box;
    for (int piece = 0; piece < pieces_in(tile); ++piece) {
      if (root_of[static_cast<std::size_t>(regions_in(tile)[piece])] != root) continue;
      cv::inRange(local_(part), piece + 1, piece + 1, here);
      cv::Mat1b target = mask(part - box.tl());
      cv::bitwise_or(target, here, target);
    }
  });
  return mask;
}

}  // namespace modslam
