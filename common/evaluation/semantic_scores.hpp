// SPDX-License-Identifier: BSD-3-Clause
/// @file Scores a found semantic map against a true one, both in the same frame.
#pragma once
#include <vector>

#include "common/evaluation/semantic_map.hpp"
#include "common/evaluation/visibility.hpp"
#include "common/evaluation/wall_end_scores.hpp"

namespace modslam {

/// Shares are 0 where there is nothing to share; the counts tell which.
struct PrecisionRecall {
  double precision = 0, recall = 0;
  double f1() const {
    return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
  }
};

/// By length. A found point counts when a true wall lies within the tolerance and within 10 degrees
/// of its direction; recall likewise over the true length that the run saw.
struct WallScore {
  double tolerance_m = 0;
  PrecisionRecall by_length;
};
struct WallScores {
  std::vector<WallScore> at;  ///< 0.05, 0.10, 0.20 m
  double found_m = 0, visible_m = 0, truth_m = 0;
  double median_error_m = 0;  ///< of the found points that count at the largest tolerance
  std::size_t found_segments = 0, truth_segments = 0;
};
WallScores score_walls(const SemanticMap& found, const SemanticMap& truth,
                       const Visibility& visibility);

/// One-to-one by the largest sum of intersection over union; a pair counts from 0.5 on. Recall is
/// over the rooms explored to 90 % or more. A found room without partner in space that no beam
/// crossed (less than half of it) is counted apart and not against precision.
struct RoomScores {
  PrecisionRecall at_half;
  double mean_iou = 0;  ///< over the explored true rooms, 0 for those without partner
  double mean_matched_iou = 0;
  std::size_t found = 0, matched = 0, explored_truth = 0, truth = 0, false_in_unseen = 0;
  std::vector<int> truth_of_found;  ///< index of the true room of each found one; -1: none
};
RoomScores score_rooms(const SemanticMap& found, const SemanticMap& truth,
                       const Visibility& visibility);

/// One-to-one by the smallest sum of centre distances, each at most 0.5 m. Recall is over true
/// doors that are visible and not closed; a closed one that is found is right.
struct DoorScores {
  PrecisionRecall at_half_metre;
  PrecisionRecall strict;  ///< both jambs within 0.5 m
  double median_distance_m = 0, median_width_error_m = 0;
  std::size_t found = 0, matched = 0, visible_truth = 0, truth = 0;
  std::size_t pairs_known = 0,
              pairs_right =
                  0;  ///< matched doors whose true rooms are known; that name them rightly
};
DoorScores score_doors(const SemanticMap& found, const SemanticMap& truth,
                       const Visibility& visibility, const RoomScores& rooms);

/// Footprints one-to-one by the largest sum of intersection over union; a pair counts from 0.3 on. A class is right when the true one is that or
/// a kind of it: a police_car is a car. There is no recall: things that touch each other or a wall are one for a laser.
struct ObjectScores {
  std::size_t found = 0, matched = 0, truth = 0;
  std::size_t named = 0, named_right = 0;  ///< of the matched ones
};
ObjectScores score_objects(const SemanticMap& found, const SemanticMap& truth);

struct SemanticScores {
  WallScores walls;
  WallEndScores wall_ends;
  RoomScores rooms;
  DoorScores doors;
  ObjectScores objects;
};
SemanticScores score_semantics(const SemanticMap& found, const SemanticMap& truth,
                               const Visibility& visibility);

}  // namespace modslam
