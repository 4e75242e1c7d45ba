// SPDX-License-Identifier: BSD-3-Clause
/// @file Connected regions of a raster, tile by tile: only tiles that changed are looked at again, and tiles are joined by what meets at their borders.
#pragma once
#include <array>
#include <set>
#include <vector>

#include "common/semantics/boxes.hpp"
#include "common/semantics/tile_lists.hpp"

namespace modslam {

/// A connected set of cells (over their sides).
struct Region {
  int cells = 0;
  cv::Rect box;
};

class TiledRegions {
 public:
  static constexpr int kTile = 64;

  /// @param mask  the raster, cells are 0 or 255. @param changed  where it changed since the last call.
  void update(const cv::Mat1b& mask, const Boxes& changed);

  void grow(const Growth& growth);
  /// In the order of their first cells, tile by tile; region k stands at k - 1.
  const std::vector<Region>& regions() const { return regions_; }
  /// A piece of a tile, from 1; 0: none. Good as long as the tile is not new.
  struct Place {
    int tile = 0, piece = 0;
  };
  Place at(const cv::Point& c) const { return {tile_of(c), local_(c)}; }
  /// From 1; 0: none.
  int region_of(const Place& place) const { return place.piece == 0 ? 0 : regions_in(place.tile)[place.piece - 1]; }
  /// Tiles whose pieces are not what they were before the last update, rising.
  const std::vector<int>& new_tiles() const { return new_tiles_; }
  /// Sets of regions may be numbered in two ways side by side.
  enum Kind { kClusters, kRooms, kKinds };
  struct SetNumbers {
    std::vector<int> of_root;
    std::vector<int> new_in;   ///< tiles of which pieces or their numbers are not what they were in the call before; some more than once
  };
  /// @param root_of  the set of each region, from 1, at 0 nothing. @return a number for each root; a set that is made of the same pieces as one of the call
  /// before has its number.
  SetNumbers number_sets(const std::vector<int>& root_of, Kind kind);
  /// Cells of a set of regions within a box.
  cv::Mat1b mask_of(const std::vector<int>& root_of, int root, const cv::Rect& box) const;
  /// Tiles that a box of cells reaches into.
  template <class Visit>
  void each_in(const cv::Rect& box, Visit visit) const {
    for (int row = box.y / kTile; row * kTile < box.br().y; ++row)
      for (int column = box.x / kTile; column * kTile < box.br().x; ++column) visit(row * columns_ + column);
  }
  cv::Rect tile_box(int tile) const { return cv::Rect(tile % columns_ * kTile, tile / columns_ * kTile, kTile, kTile) & cv::Rect({0, 0}, local_.size()); }
  /// How many pieces a tile has, and the regions of these.
  int pieces_in(int tile) const { return static_cast<int>(pieces_.size(tile)); }
  const int* regions_in(int tile) const { return region_of_.data() + pieces_.first(tile); }
  /// The pieces in a row of cells, each from 1 in its own tile; 0: none.
  const std::uint16_t* pieces(int row) const { return local_[row]; }

 private:
  /// The set that a piece was in: its number, and how many pieces it had.
  struct Known {
    int number = 0, pieces = 0;
    bool operator==(const Known& o) const { return number == o.number && pieces == o.pieces; }
  };
  struct Piece {
    int cells = 0;
    cv::Rect box;
    std::array<Known, kKinds> known;
  };
  using Meetings = std::vector<std::pair<std::uint16_t, std::uint16_t>>;   ///< pieces of a tile and those of a neighbour
  static int columns_in(const cv::Size& size) { return (size.width + kTile - 1) / kTile; }
  static int rows_in(const cv::Size& size) { return (size.height + kTile - 1) / kTile; }
  int tile_of(const cv::Point& c) const { return c.y / kTile * columns_ + c.x / kTile; }
  std::vector<Piece> label(int tile, const cv::Mat1b& mask, bool& is_new);
  Meetings meetings(const cv::Point& from, const cv::Point& step, int count, const cv::Point& across) const;
  void link(const std::set<int>& tiles);
  void join();

  int columns_ = 0, tile_count_ = 0;
  std::array<int, kKinds> last_number_{};
  cv::Mat1w local_;
  TileLists<Piece> pieces_;
  TileLists<Meetings::value_type> right_, below_;   ///< of a tile and its neighbour to that side
  std::vector<int> new_tiles_;
  std::vector<int> region_of_;  ///< of each piece
  std::vector<Region> regions_;
};

}  // namespace modslam
