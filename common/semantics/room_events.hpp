// SPDX-License-Identifier: BSD-3-Clause
/// @file What became of rooms from one update to the next: some were parted, some turned out to be one.
#pragma once
#include <vector>

#include "common/semantics/types.hpp"

namespace modslam {

/// A room whose id is gone and that lies mostly in one that is there was merged into it; a room with a new id that lies mostly in one that was there was
/// split off it. Merges first, by id of the room they made. Both lists have their ids.
std::vector<RoomEvent> room_events(const std::vector<Room>& before, const std::vector<Room>& now);

}  // namespace modslam
