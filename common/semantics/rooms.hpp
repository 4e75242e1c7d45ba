// SPDX-License-Identifier: BSD-3-Clause
/// @file Rooms: what belongs together is read from the seen floor, the outline from the faces that
/// the walls enclose.
///
/// The thesis takes every loop of walls for a room, seen or not; a raster of the seen floor alone
/// has ragged outlines. Here regions of seen floor (regions.hpp) choose among the faces of the
/// lengthened walls and door lines: a face belongs to the region that fills it, one that nobody has
/// seen belongs to none. Where walls are missing the region's own contour stands in.
#pragma once
#include <vector>

#include "common/semantics/config.hpp"
#include "common/semantics/faces.hpp"
#include "common/semantics/regions.hpp"
#include "common/semantics/types.hpp"

namespace modslam {

/// @param walls  faces of walls.  @param doors  jamb to jamb.  @param furniture  sides of things
/// that hide walls.
/// @param raster   labelled by label_regions.
/// @return rooms without ids, evidence and name.
std::vector<Room> find_rooms(const Raster& raster, const std::vector<Segment>& walls,
                             const std::vector<Segment>& doors,
                             const std::vector<Segment>& furniture, const SemanticsConfig& config);

}  // namespace modslam
