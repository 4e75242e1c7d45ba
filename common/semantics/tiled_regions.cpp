// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/tiled_regions.hpp"

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>

#include "common/graph/disjoint_sets.hpp"

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

/// Pieces are numbered in the order of their first cells, row by row. Those that stayed as they were are known again. @param is_new  set when any did not.
std::vector<TiledRegions::Piece> TiledRegions::label(int tile, const cv::Mat1b& mask, bool& is_new) {
  const cv::Rect box = tile_box(tile);
  cv::Mat1w labels = local_(box);
  const cv::Mat1w labels_before = labels.clone();
  const Piece* before = pieces_.begin(tile);
  std::vector<Piece> now;
  labels.setTo(0);
  const Runs found(mask(box));
  const std::vector<Run>& runs = found.runs();
  std::vector<std::uint16_t> piece(runs.size()), was;  // was: the piece before that all cells of a piece were in
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Run& run = runs[k];
    const std::size_t root = found.root(k);
    const std::uint16_t *old = labels_before[run.y] + run.begin, *old_end = labels_before[run.y] + run.end;
    if (root == k) {
      now.emplace_back();
      was.push_back(*old);
      piece[k] = static_cast<std::uint16_t>(now.size());
    }
    piece[k] = piece[root];
    std::uint16_t& here = was[piece[k] - 1U];
    if (std::any_of(old, old_end, [&](std::uint16_t one) { return one != here; })) here = 0;
    std::fill(labels[run.y] + run.begin, labels[run.y] + run.end, piece[k]);
    now[piece[k] - 1U].cells += run.end - run.begin;
    now[piece[k] - 1U].box |= cv::Rect(box.x + run.begin, box.y + run.y, run.end - run.begin, 1);
  }
  is_new = pieces_.size(tile) != now.size();
  for (std::size_t k = 0; k < now.size(); ++k) {
    const bool stays = was[k] > 0 && before[was[k] - 1U].cells == now[k].cells;
    if (stays) now[k].known = before[was[k] - 1U].known;
    is_new = is_new || !stays || was[k] != k + 1;
  }
  return now;
}

/// Of the cells along a border, and those across it.
TiledRegions::Meetings TiledRegions::meetings(const cv::Point& from, const cv::Point& step, int count, const cv::Point& across) const {
  Meetings out;
  for (int k = 0; k < count; ++k) {
    const cv::Point c = from + k * step;
    const Meetings::value_type both(local_(c), local_(c + across));
    if (both.first && both.second && (out.empty() || out.back() != both)) out.push_back(both);
  }
  return out;
}

void TiledRegions::link(const std::set<int>& tiles) {
  std::map<int, Meetings> right, below;
  for (const int tile : tiles) {
    const cv::Rect box = tile_box(tile);
    if (box.br().x < local_.cols) right[tile] = meetings({box.br().x - 1, box.y}, {0, 1}, box.height, {1, 0});
    if (box.br().y < local_.rows) below[tile] = meetings({box.x, box.br().y - 1}, {1, 0}, box.width, {0, 1});
  }
  right_.replace(right);
  below_.replace(below);
}

void TiledRegions::join() {
  DisjointSets sets(pieces_.all().size());
  for (const auto& [meetings, apart] : {std::pair(&right_, 1), std::pair(&below_, columns_)})
    for (int tile = 0; tile < tile_count_; ++tile)
      for (const auto* both = meetings->begin(tile); both != meetings->end(tile); ++both)
        sets.join_lowest(pieces_.first(tile) + both->first - 1, pieces_.first(tile + apart) + both->second - 1);
  region_of_.assign(sets.size(), 0);
  regions_.clear();
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const std::size_t top = sets.root(k);
    if (top == k) {
      regions_.emplace_back();
      region_of_[k] = static_cast<int>(regions_.size());
    }
    region_of_[k] = region_of_[top];
    Region& region = regions_[static_cast<std::size_t>(region_of_[k] - 1)];
    region.cells += pieces_.all()[k].cells;
    region.box |= pieces_.all()[k].box;
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
  std::vector<Piece>& pieces = pieces_.all();
  const auto set_of = [&](std::size_t piece) -> Set& { return sets[static_cast<std::size_t>(root_of[static_cast<std::size_t>(region_of_[piece])])]; };
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    Set& set = set_of(k);
    const Known& known = pieces[k].known[kind];
    if (set.pieces++ == 0) set.before = known;
    else set.same = set.same && known == set.before;
  }
  SetNumbers numbers{std::vector<int>(sets.size(), 0), new_tiles_};
  for (std::size_t k = 1; k < sets.size(); ++k) {
    Set& set = sets[k];
    if (set.pieces == 0) continue;
    set.same = set.same && set.before.number > 0 && set.before.pieces == set.pieces;
    if (!set.same) set.before = {++last_number_[kind], set.pieces};
    numbers.of_root[k] = set.before.number;
  }
  int tile = 0;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Set& set = set_of(k);
    if (set.same) continue;
    pieces[k].known[kind] = set.before;
    while (pieces_.first(tile + 1) <= k) ++tile;
    numbers.new_in.push_back(tile);
  }
  return numbers;
}

/// By whole tiles.
void TiledRegions::grow(const Growth& growth) {
  const int columns_before = columns_;
  columns_ = columns_in(growth.size);
  tile_count_ = columns_ * rows_in(growth.size);
  pieces_.grow(columns_before, columns_, rows_in(growth.size), growth.shift.x / kTile, growth.shift.y / kTile);
  for (TileLists<Meetings::value_type>* lists : {&right_, &below_}) lists->grow(columns_before, columns_, rows_in(growth.size), growth.shift.x / kTile, growth.shift.y / kTile);
  for (Piece& piece : pieces_.all()) piece.box += growth.shift;
  local_ = grown(local_, growth, 0);
}

void TiledRegions::update(const cv::Mat1b& mask, const Boxes& changed) {
  new_tiles_.clear();
  if (local_.size() != mask.size()) {
    local_ = cv::Mat1w(mask.size(), std::uint16_t{0});
    columns_ = columns_in(mask.size());
    tile_count_ = columns_ * rows_in(mask.size());
    pieces_ = TileLists<Piece>(tile_count_);
    right_ = below_ = TileLists<Meetings::value_type>(tile_count_);
  }
  std::set<int> relabel, relink;
  for (const cv::Rect& box : changed)
    each_in(box, [&](int tile) {
      relabel.insert(tile);
      relink.insert(tile);
      if (tile % columns_ > 0) relink.insert(tile - 1);
      if (tile >= columns_) relink.insert(tile - columns_);
    });
  std::map<int, std::vector<Piece>> pieces;
  for (const int tile : relabel) {
    bool is_new = false;
    pieces[tile] = label(tile, mask, is_new);
    if (is_new) new_tiles_.push_back(tile);
  }
  pieces_.replace(pieces);
  link(relink);
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
