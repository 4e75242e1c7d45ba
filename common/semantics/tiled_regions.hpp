// SPDX-License-Identifier: BSD-3-Clause
/// @file Connected regions of a raster, tile by tile: only tiles that changed are looked at again, and tiles are joined by what meets at their borders.
#pragma once
#include <tuple>
#include <vector>

#include "common/semantics/boxes.hpp"

namespace modslam {

/// A connected set of cells (over their sides).
struct Region {
  struct Member {
    int tile, local, stamp;  ///< tile, number within it, and when the tile last changed
    bool operator==(const Member& o) const { return tile == o.tile && local == o.local && stamp == o.stamp; }
    bool operator<(const Member& o) const { return std::tie(tile, local, stamp) < std::tie(o.tile, o.local, o.stamp); }
  };
  std::vector<Member> members;
  int cells = 0;
  cv::Rect box;
};

class TiledRegions {
 public:
  static constexpr int kTile = 64;

  /// @param mask  the raster, cells are 0 or 255. @param changed  where it changed since the last call.
  void update(const cv::Mat1b& mask, const Boxes& changed);

  const std::vector<Region>& regions() const { return regions_; }   ///< number k stands at k - 1
  /// Number of the region at a cell, from 1; 0: none.
  int at(const cv::Point& c) const {
    const int local = local_(c);
    return local == 0 ? 0 : numbers_[static_cast<std::size_t>(tiles_[static_cast<std::size_t>(tile_of(c))].first + local - 1)];
  }
  /// Cells of a region within a box.
  cv::Mat1b mask_of(const Region& region, const cv::Rect& box) const;
  int tile_count() const { return static_cast<int>(tiles_.size()); }
  cv::Rect tile_box(int tile) const { return cv::Rect(tile % columns_ * kTile, tile / columns_ * kTile, kTile, kTile) & cv::Rect({0, 0}, local_.size()); }
  int stamp(int tile) const { return tiles_[static_cast<std::size_t>(tile)].stamp; }
  /// Numbers of the regions of a tile's own pieces.
  void numbers_in(int tile, std::vector<int>& numbers) const;
  /// Numbers of the pieces in a row of cells, each from 1 in its own tile; 0: none.
  const std::uint16_t* pieces(int row) const { return local_[row]; }

 private:
  struct Tile {
    int stamp = 0, first = 0;                         ///< first: place of its first piece among all
    std::vector<int> cells;
    std::vector<cv::Rect> boxes;
    std::vector<std::pair<int, int>> right, below;    ///< its pieces and those of the neighbour that they meet
  };
  int tile_of(const cv::Point& c) const { return c.y / kTile * columns_ + c.x / kTile; }
  void label(int tile, const cv::Mat1b& mask);
  void link(int tile);
  void join();

  int columns_ = 0, round_ = 0;
  cv::Mat1w local_;
  std::vector<Tile> tiles_;
  std::vector<int> numbers_;  ///< region of each piece
  std::vector<Region> regions_;
};

}  // namespace modslam
