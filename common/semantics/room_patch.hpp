// SPDX-License-Identifier: BSD-3-Clause
/// @file A region of the floor with what lies around it, and the room that it makes: its outline with the floor that furniture hides.
#pragma once
#include "common/semantics/known_space.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

struct RoomOptions {
  double min_area_m2 = 1.5;
  double min_enclosed = 0.6;   ///< share of the outline that must lie on walls or openings
  double glimpse_enclosed = 0.72;  ///< the same for small regions with one way in
  double glimpse_m2 = 12;              ///< larger ones are not small
  double min_explored = 0.5;
};

/// What one room is worked out from: the part of the rasters around its region.
struct RoomPatch {
  cv::Mat1b mask;      ///< the region
  cv::Mat1b foreign;   ///< other regions
  cv::Mat1b barrier;   ///< hits and openings, fattened
  cv::Mat1b doorways;  ///< openings and what lies near them
  cv::Mat1b seen;
  cv::Mat1b matters;   ///< bits: where the answer read barrier, foreign and seen
  KnownSpace space;    ///< shares its pictures
  bool parking;        ///< cars stand in it
  bool glimpse;        ///< small, with one way in
};

/// Works out the room. Of the patch, `mask` becomes the cells of the room and `matters` what was read. @return whether it is one.
bool make_room(RoomPatch& patch, const RoomOptions& options, Room& room);

/// What make_room() may read of a patch, as bits of a byte for each cell. What it did read, `matters`, are bits beside them.
cv::Mat1b picture_of(const RoomPatch& patch);

/// Whether another picture says the same wherever the answer to this one read it. The region is read everywhere, doorways in it.
bool says_the_same(const cv::Mat1b& known, const cv::Mat1b& other);

}  // namespace modslam
