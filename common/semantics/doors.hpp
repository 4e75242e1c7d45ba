// SPDX-License-Identifier: BSD-3-Clause
/// @file Doors: openings between wall ends that beams have passed, confirmed by the jamb pairs that
/// single scans saw.
#pragma once
#include <vector>

#include "common/semantics/config.hpp"
#include "common/semantics/evidence.hpp"
#include "common/semantics/types.hpp"
#include "common/semantics/walls.hpp"

namespace modslam {

struct DoorCandidate {
  Segment segment;      ///< jamb to jamb, in the middle of a wall whose both faces were seen
  double evidence = 0;  ///< log-odds
  int votes = 0;        ///< scans whose virtual sensor saw the pair of jambs
};

/// @param jamb_pairs  of all scans, map frame.
/// @return candidates that do not overlap, best first. Whether one separates two regions is not
/// judged here.
std::vector<DoorCandidate> find_door_candidates(const std::vector<WallFace>& faces,
                                                const Evidence& evidence,
                                                const std::vector<Segment>& jamb_pairs,
                                                const SemanticsConfig& config);

}  // namespace modslam
