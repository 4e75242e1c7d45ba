// SPDX-License-Identifier: BSD-3-Clause
/// @file Walls from the segments of many scans: the segment merging of the thesis (algorithm 4), done with sums and block by block.
///
/// Lines of one block that are one line become a band, bands of neighbouring blocks that go on in each other become one; a wall is a stretch of a band
/// that enough scans have seen. After a change only its blocks, and the bands that run through them, are worked out again.
/// A band ends at gaps wider than doors, so it is as long as a corridor, not as a building.
#pragma once
#include <array>

#include "common/semantics/boxes.hpp"
#include "common/semantics/plan_index.hpp"
#include "common/semantics/slots.hpp"
#include "common/semantics/wall_band.hpp"

namespace modslam {

/// Segments of one scan, placed in the map.
using PlacedSegments = std::vector<Segment>;

class WallMap {
 public:
  using IsSolid = std::function<bool(const Eigen::Vector2d&)>;
  using Finish = std::function<void(Wall&)>;

  explicit WallMap(const WallMapOptions& options) : options_(options) {}

  /// A segment of one scan, map frame; sign -1 takes it back.
  void add(const Segment& segment, int sign) { blocks_.add(segment, sign); }

  /// What became of the walls. `altered` stay; what is known of them, but for their ends, may be new.
  struct News : NumberNews {
    Numbers altered;
  };
  /// @param is_solid  whether the raster knows something solid around a place: a stretch that most beams passed is no wall. @param finish  fills in what
  /// else a wall has. @param changed  plan_box()es in which the answers of either may be new.
  News update(const IsSolid& is_solid, const Finish& finish, const Boxes& changed);

  /// By number. A wall keeps its number as long as its ends stay the same, to the bit; numbers say nothing about order.
  const Slots<Wall>& walls() const { return walls_; }
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  struct Neighbours {
    std::size_t before = kNone, after = kNone;
  };
  /// The walls before and after one on its band.
  const Neighbours& beside(std::size_t number) const { return beside_[number]; }
  /// All bands with a wall each.
  std::vector<WallBand> bands() const;

 private:
  using Index = WallBlocks::Index;
  using Member = std::pair<Index, int>;   ///< block, number of the band in it
  using Links = std::vector<std::pair<Member, Member>>;
  using Ends = std::array<double, 4>;
  /// Bands that go on in each other, and the lines that they make.
  struct Chain {
    std::vector<Member> members;
    Numbers lines;
  };
  /// Bands that are one, with the walls on it, in order along it.
  struct Line {
    Band band;
    Numbers walls;
    bool is_there = true;
  };

  bool find_bands(const Index& index, std::set<Member>& fresh);
  Links links_of(const Index& index) const;
  void find_links(const Index& index, std::set<Index>& relinked);
  std::vector<Member> dissolve(const std::set<Index>& blocks, std::vector<Chain>& dissolved);
  std::vector<std::vector<Member>> chains_of(const std::vector<Member>& loose) const;
  std::set<Member> rechain(const std::set<Index>& blocks, const std::set<Member>& fresh, Numbers& gone);
  Numbers join(const std::set<Member>& chains, Numbers& gone);
  Numbers lines_near(const Boxes& changed) const;
  News read_walls(const Numbers& gone, const Numbers& stale, const IsSolid& is_solid, const Finish& finish, const Boxes& changed);
  const Band& band(const Member& member) const { return bands_.at(member.first)[static_cast<std::size_t>(member.second)]; }

  static constexpr double kSquare_m = 6.4;
  WallMapOptions options_;
  WallBlocks blocks_;
  std::map<Index, std::vector<Band>> bands_;
  std::map<Index, Links> links_;               ///< from a block to those after it
  std::map<Member, Chain> chains_;             ///< by first member
  std::map<Index, std::set<Member>> through_;  ///< first members of the chains that have bands in a block
  Slots<Line> lines_;
  PlanIndex line_index_{kSquare_m};
  Slots<Wall> walls_;
  std::vector<Neighbours> beside_;             ///< by number of the wall
};

/// Box of cells of 0.05 m from the map's origin around two corners.
cv::Rect plan_box(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m);

/// All at once. Same input, same order out.
std::vector<WallBand> merge_segments(const std::vector<PlacedSegments>& scans, const WallMapOptions& options, const WallMap::IsSolid& is_solid);

}  // namespace modslam
