// SPDX-License-Identifier: BSD-3-Clause
/// @file Openings: places where the floor narrows between two corners of what bounds it, or between a corner and a wall. Doors are
/// openings, the mouth of a corridor is one; most are none, and the features tell.
#pragma once
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "common/semantics/floor.hpp"
#include "common/semantics/opening_model.hpp"
#include "common/semantics/outline.hpp"
#include "common/semantics/wall_set.hpp"

namespace modslam {

/// What is measured of a cut through the floor. Pairs are (less, more) of its two ends or its two sides, so that neither is first.
enum OpeningFeature {
  kWidth,                             ///< [m]
  kSolidLess, kSolidMore,             ///< [m] how far the wall goes on, in line, beyond the ends; at most 1
  kHitLess, kHitMore,                 ///< share of the first 0.6 m beyond the ends where something was hit
  kDepthLess, kDepthMore,             ///< [m] free way off the cut to the two sides; at most 4
  kRoomyLess, kRoomyMore,             ///< largest clearance met on that way over half the width
  kClearLess, kClearMore,             ///< [m] that clearance itself
  kTurnLess, kTurnMore,               ///< [rad] turn of the outline at the ends; 0 where a wall is met square
  kAlignLess, kAlignMore,             ///< |cos| between the cut and the outline at the ends
  kFlareLess, kFlareMore,             ///< free width 0.35 m beside the cut, over its own; at most 4
  kMidClear,                          ///< clearance in the cut's middle over half its width
  kLocal,                             ///< its width over that of the narrowest cut near by
  kWallLess, kWallMore,               ///< [m] length of the longest wall at the ends; at most 3
  kOpeningFeatures
};

/// Where the floor narrows, and how sure it is that two rooms are parted there.
struct Gap {
  Eigen::Vector2d a, b;               ///< map frame [m]
  double probability = 0;             ///< of parting two rooms
  double width_m() const { return (b - a).norm(); }
  Eigen::Vector2d centre() const { return 0.5 * (a + b); }
  /// Surest first.
  auto order() const { return std::tuple(-probability, a.x(), a.y(), b.x(), b.y()); }
};

struct Opening : Gap {
  std::array<float, kOpeningFeatures> features{};
};

/// What came and what went of a set of gaps.
struct GapNews {
  std::vector<Gap> gone, come;
};

/// Openings that the floor may be cut at.
struct CutLimits {
  double min_probability = 0.5;
  double slit_m = 0.6;             ///< narrower ones that nobody passes, as windows are, may part rooms beside surer ones ...
  double slit_probability = 0.05;  ///< ... if they are at least this sure
  bool take(const Gap& gap) const {
    return gap.probability >= min_probability || (gap.probability >= slit_probability && gap.width_m() < slit_m);
  }
};

/// A straight way across the floor from one of its corners to another, or square to an edge. Cells.
struct FloorCut {
  Eigen::Vector2d a, b;
  Corner first, second;                ///< at a and b; no second where b lies on an edge
  bool to_corner = true;
  Eigen::Vector2d edge{0, 0};          ///< direction of that edge
  double length() const { return (b - a).norm(); }
  Eigen::Vector2d centre() const { return 0.5 * (a + b); }
};

/// Cells that the features of a cut were read from, in each raster of the floor.
struct CutReads {
  cv::Rect open, clearance, solid;
};

class CutFeatures;

/// Keeps the openings of a floor in step with it, block by block: a cut belongs to the block of its first corner.
class OpeningMap {
 public:
  OpeningMap(double max_width_m, const OpeningModel& model) : max_width_m_(max_width_m), model_(model) {}

  /// @param change, walls_changed  where floor and walls are new since the last call.
  void update(const Floor& floor, const KnownSpace& space, const WallSet& walls, const FloorChange& change, const Boxes& walls_changed);
  void grow(const Growth& growth);

  /// What is new since the last call of those that may be cut. @param limits  the same each time.
  GapNews take_news(const CutLimits& limits);
  std::vector<Opening> all() const;

 private:
  /// A cut, with what was measured of it.
  struct Measured {
    FloorCut cut;
    Opening opening;
    CutReads reads;
    bool known = false;
  };
  struct Block {
    cv::Rect box;
    Outline outline;
    std::vector<Measured> cuts;              ///< shortest first
    std::vector<Gap> gaps;                   ///< take_news() told of these the last time
    Boxes news;                              ///< middles of cuts that came or went in this round
  };
  /// Where things are new that features depend on.
  struct News {
    Boxes open, clearance, solid, walls;
  };
  using Index = std::pair<int, int>;   ///< column, row

  Boxes retrace(const Floor& floor, const Boxes& open);
  void recollect(const Floor& floor, const Boxes& changed);
  void take_cuts(const Index& index, Block& block, const std::vector<FloorCut>& cuts);
  template <class Visit>
  void each_near(const cv::Rect& box, Visit visit);
  std::vector<const Block*> around(const Index& index) const;
  double narrowest_near(const Index& index, const FloorCut& cut, double cell_m) const;
  void measure(const Index& index, const CutFeatures& features, double cell_m, const News& news);

  double max_width_m_;
  OpeningModel model_;
  std::map<Index, Block> blocks_;
  std::set<Index> with_news_;     ///< blocks where cuts came or went in this round, ...
  std::set<Index> untold_;        ///< ... and those that take_news() does not know of
};

/// All cuts of at most max_width_m that a corner of the floor's outline takes part in, with features and probability.
std::vector<Opening> find_openings(const Floor& floor, const KnownSpace& space, const std::vector<Wall>& walls, double max_width_m,
                                   const OpeningModel& model);

}  // namespace modslam
