// SPDX-License-Identifier: BSD-3-Clause
/// @file The floor cut at its openings: every region is a room or a part of one that was not seen whole.
#pragma once
#include <map>
#include <set>

#include "common/semantics/cut_choice.hpp"
#include "common/semantics/memo.hpp"
#include "common/semantics/parking_slots.hpp"
#include "common/semantics/tiled_regions.hpp"

namespace modslam {

/// A region of the floor after small ones joined their neighbours.
struct FloorRegion {
  int number = 0;         ///< stays as long as the region stays the same
  cv::Rect box;
  int cells = 0;
  bool parking = false;   ///< gaps between parked cars belong to it
  int ways = 0;           ///< ends of cuts that part it from others

  /// Whether it is small, with one way in. When it is not closed in it is no more than what was seen through that way.
  bool is_glimpse(double cell_m, double most_m2) const { return ways == 1 && cells * cell_m * cell_m < most_m2; }
};

struct Partition {
  cv::Mat1i labels;                    ///< 0: no floor; else the number of the region
  std::vector<FloorRegion> regions;    ///< by rising number
  std::vector<CutOpening> cuts;        ///< surest first; each parts two regions

  /// Null: there is none of that number.
  const FloorRegion* find(int number) const;
};

struct PartitionOptions {
  CutLimits cuts;
  double min_room_m2 = 1.5;
  double small_m2 = 5.0;
  double min_walled = 0.15;   ///< share of a small region's outline, openings left out, that lies on walls: between parked cars there are none
};

/// Takes the surest openings first, none that says the same as one before. A slit through which beams went does not join two rooms that a sure
/// door parts: pieces are clustered by the log-odds of all cuts between them. Regions that are too small to be rooms, or have too little wall
/// around them, join a neighbour through their least sure opening. No walls given: none are asked for.
class FloorParter {
 public:
  explicit FloorParter(const PartitionOptions& options) : options_(options) {}

  /// @param news  of the gaps that options.cuts take. @param open, walls_changed  where floor and walls changed since the last call.
  /// @return where there is a region now and was none, or the other way round, and around cuts that are new or gone.
  Boxes update(const Floor& floor, const KnownSpace& space, const WallSet& walls, const GapNews& news, const Boxes& open, const Boxes& walls_changed);
  const Partition& partition() const { return partition_; }
  void grow(const Growth& growth);

 private:
  /// What is kept of a chosen cut.
  struct Cut {
    TiledRegions::Place left, right;   ///< beside it
    int role = kNone;                  ///< or kParts, or the number of the region that it was healed in
  };
  static constexpr int kNone = 0, kParts = -1;

  static cv::Rect box_of(const Gap& cut, const KnownSpace& space, double margin_m);
  Boxes draw_cuts(const Floor& floor, const KnownSpace& space, const NumberNews& change, const Boxes& open);
  std::vector<CutOpening> look_beside(const KnownSpace& space, const NumberNews& change);
  void find_clusters(std::vector<CutOpening>& cuts);
  cv::Mat1b mask_of(int cluster) const;
  double walled_share(int cluster, const Floor& floor, const KnownSpace& space, const WallSet& walls) const;
  std::vector<double> areas_m2(const Floor& floor, const KnownSpace& space, const WallSet& walls);
  std::vector<int> join_clusters(const std::vector<CutOpening>& cuts, const std::set<int>& slots, std::vector<double> area_m2) const;
  std::vector<int> number_regions(const std::vector<int>& roots, const std::set<int>& slots, const std::vector<CutOpening>& cuts);
  Boxes take_cuts(std::vector<CutOpening>& cuts, const std::vector<int>& number_of, const NumberNews& change, const KnownSpace& space);
  Boxes paint(const Floor& floor, const KnownSpace& space);

  PartitionOptions options_;
  Partition partition_;
  CutChoice choice_;
  TiledRegions tiles_;
  cv::Mat1b parted_;                            ///< the floor without its cuts
  std::vector<Cut> cuts_;                       ///< by number
  bool moved_ = false;                          ///< the raster grew since the last round
  std::vector<int> cluster_of_;                 ///< of each region of tiles_, from 1
  std::vector<Region> clusters_;                ///< cluster k stands at k - 1
  std::vector<int> cluster_numbers_;            ///< at k: stays as long as the cluster stays the same
  Memo<int, double> walled_;                    ///< by number of the cluster
  ParkingSlots slots_;
  std::vector<int> number_of_;                  ///< final number of each region of tiles_
  std::vector<int> unpainted_;                  ///< tiles of which labels are not what number_of_ says
};

/// All at once, from openings in any order.
Partition part_floor(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, const std::vector<Opening>& openings,
                     const PartitionOptions& options);

}  // namespace modslam
