// SPDX-License-Identifier: BSD-3-Clause
/// @file Walls from the segments of many scans: the segment merging of the thesis (algorithm 4), done with sums and block by block.
///
/// Lines of one block that are one line become a band, bands of neighbouring blocks that go on in each other become one; a wall is a stretch of a band
/// that enough scans have seen. After a change only its blocks, and the bands that run through them, are worked out again.
/// A band ends at gaps wider than doors, so it is as long as a corridor, not as a building.
#pragma once
#include <array>

#include "common/semantics/boxes.hpp"
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

  /// @param is_solid  whether the raster knows something solid around a place: a stretch that most beams passed is no wall. @param finish  fills in what
  /// else a wall has. @param changed  plan_box()es in which the answers of either may be new. @return bands with a wall each, in an order that depends on nothing but what they are;
  /// good until the next update.
  std::vector<const WallBand*> update(const IsSolid& is_solid, const Finish& finish, const Boxes& changed);

 private:
  using Index = WallBlocks::Index;
  using Member = std::pair<Index, int>;   ///< block, number of the band in it
  using Links = std::vector<std::pair<Member, Member>>;
  /// Bands that go on in each other, and the walls on them.
  struct Chain {
    std::vector<Member> members;
    cv::Rect from;                        ///< cells that its walls depend on, but for the bands
    std::vector<WallBand> bands;
  };
  using KnownWalls = std::map<std::array<double, 4>, Wall>;   ///< by both ends: of a long band with news at one end most walls stay

  /// @param fresh  takes the bands that are not what they were.
  void find_bands(const Index& index, std::set<Member>& fresh);
  void find_links(const Index& index);
  std::vector<Member> dissolve(const std::set<Index>& blocks, std::vector<Chain>& dissolved);
  std::vector<std::vector<Member>> chains_of(const std::vector<Member>& loose) const;
  cv::Rect surroundings(const std::vector<Member>& members) const;
  void find_walls(Chain& chain, const IsSolid& is_solid, const Finish& finish, const KnownWalls& known) const;
  const Band& band(const Member& member) const { return bands_.at(member.first)[static_cast<std::size_t>(member.second)]; }

  WallMapOptions options_;
  WallBlocks blocks_;
  std::map<Index, std::vector<Band>> bands_;
  std::map<Index, Links> links_;               ///< from a block to those after it
  std::map<Member, Chain> chains_;             ///< by first member
  std::map<Index, std::set<Member>> through_;  ///< first members of the chains that have bands in a block
  /// Of the chains, in their order: what is asked of each of them in every update.
  struct Entry {
    Member first;
    cv::Rect from;
    Chain* chain;
  };
  std::vector<Entry> entries_;
};

/// Box of cells of 0.05 m from the map's origin around two corners.
cv::Rect plan_box(const Eigen::Vector2d& p, const Eigen::Vector2d& q, double margin_m);

/// All at once. Same input, same order out.
std::vector<WallBand> merge_segments(const std::vector<PlacedSegments>& scans, const WallMapOptions& options, const WallMap::IsSolid& is_solid);

}  // namespace modslam
