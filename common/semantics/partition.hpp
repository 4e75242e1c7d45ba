// SPDX-License-Identifier: BSD-3-Clause
/// @file The floor cut at its openings: every region is a room or a part of one that was not seen whole.
#pragma once
#include <map>
#include <set>
#include <tuple>

#include "common/semantics/cut_choice.hpp"
#include "common/semantics/memo.hpp"
#include "common/semantics/tiled_regions.hpp"

namespace modslam {

/// An opening that was cut, and the regions on its two sides (left and right of a -> b; 0: none).
struct CutOpening {
  Opening opening;
  int left = 0, right = 0;
};

/// A region of the floor after small ones joined their neighbours.
struct FloorRegion {
  cv::Rect box;
  int cells = 0;
  bool parking = false;   ///< gaps between parked cars belong to it
  int ways = 0;           ///< ends of cuts that part it from others
};

struct Partition {
  cv::Mat1i labels;                    ///< 0: no floor; else the number of the region
  std::map<int, FloorRegion> regions;  ///< by number; a region keeps its number as long as it stays the same
  std::vector<CutOpening> cuts;        ///< surest first; each parts two regions
};

/// Small regions with one way in. When they are not closed in they are no more than what was seen through that way.
std::set<int> glimpses(const Partition& partition, double cell_m, double most_m2);

struct PartitionOptions {
  double min_probability = 0.5;
  double min_room_m2 = 1.5;
  double small_m2 = 5.0;
  double min_walled = 0.15;   ///< share of a small region's outline, openings left out, that lies on walls: between parked cars there are none
};

/// Takes the surest openings first, none that says the same as one before. Regions that are too small to be rooms, or have too little wall
/// around them, join a neighbour through their least sure opening. No walls given: none are asked for.
class FloorParter {
 public:
  explicit FloorParter(const PartitionOptions& options) : options_(options) {}

  /// @param openings  all of at least options.min_probability, surest first. @param open, walls_changed  where floor and walls changed since the last call.
  /// @return where there is a region now and was none, or the other way round, and around cuts that are new or gone.
  Boxes update(const Floor& floor, const KnownSpace& space, const WallSet& walls, const std::vector<Opening>& openings, const Boxes& open,
               const Boxes& walls_changed);
  const Partition& partition() const { return partition_; }
  void grow(const Growth& growth);

 private:
  struct Niche {
    Eigen::Vector2d centre, across;  ///< of a dead end as a box; across: along its short sides
    double width, depth;             ///< [cells]
  };

  /// What is drawn of a cut: its line, and the region that it heals.
  struct CutLine {
    Eigen::Vector2d a, b;
    int region = 0;
    auto order() const { return std::tuple(a.x(), a.y(), b.x(), b.y(), region); }
    bool operator<(const CutLine& o) const { return order() < o.order(); }
  };

  static cv::Rect box_of(const CutLine& cut, const KnownSpace& space, double margin_m);
  static Boxes news_of(const std::vector<CutLine>& before, const std::vector<CutLine>& now, const KnownSpace& space, double margin_m);
  Boxes draw_cuts(const Floor& floor, const KnownSpace& space, std::vector<CutLine> cuts, const Boxes& open);
  double walled_share(const Region& region, int number, const Floor& floor, const KnownSpace& space, const WallSet& walls) const;
  Niche niche_of(const Region& region, int number) const;
  std::set<int> find_slots(const std::vector<CutOpening>& cuts, const Floor& floor);
  void number_regions(const std::vector<int>& roots, const std::set<int>& slots, const std::vector<CutOpening>& cuts);
  Boxes paint(const Floor& floor, const KnownSpace& space, std::vector<CutLine> healed);

  PartitionOptions options_;
  Partition partition_;
  CutChoice choice_;
  TiledRegions tiles_;
  cv::Mat1b parted_;                            ///< the floor without its cuts
  std::vector<CutLine> drawn_, kept_, healed_;  ///< of the last round, in order
  Memo<int, double> walled_;                    ///< by number of the region of tiles_
  Memo<int, Niche> niches_;
  std::vector<int> number_of_;                  ///< final number of each region of tiles_
  std::vector<std::vector<int>> painted_;       ///< numbers in each tile, as painted
  std::vector<int> painted_stamp_;
};

/// All at once, from openings in any order.
Partition part_floor(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, std::vector<Opening> openings,
                     const PartitionOptions& options);

}  // namespace modslam
