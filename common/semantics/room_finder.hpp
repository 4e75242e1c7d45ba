// SPDX-License-Identifier: BSD-3-Clause
/// @file Rooms: regions of the parted floor that are closed in by what was hit and by openings.
///
/// The thesis looked for cycles of wall ends; one hidden corner breaks a cycle, and cycles round unseen space are rooms too. Here a region
/// of seen floor is a room when its outline lies on hits, walls and openings (the closed cycle), and unexplored space cannot be one.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "common/semantics/partition.hpp"
#include "common/semantics/room_patch.hpp"

namespace modslam {

/// Keeps the rooms of a floor in step with it.
class RoomMap {
 public:
  explicit RoomMap(const RoomOptions& options) : options_(options) {}

  /// @param changed  where partition, floor or space are new since the last call.
  std::vector<Room> update(const Partition& partition, const Floor& floor, const KnownSpace& space, const Boxes& changed);
  void grow(const Growth& growth);

  /// Outlines of rooms that are there since the last update, or are not any more.
  struct News {
    std::vector<Corners> gone, come;
  };
  const News& news() const { return news_; }
  /// Whether a region of the partition of the last update is one.
  bool is_room(int region) const;

 private:
  /// What was looked at, and what came of it. Most of what is new around a room makes no difference to it.
  struct Look {
    FloorRegion region;
    bool glimpse;
    cv::Mat1b picture;           ///< all that the answer depends on, and what of it
    std::optional<Room> room;
  };
  using Looks = std::vector<std::unique_ptr<Look>>;

  RoomPatch patch_of(const FloorRegion& region, const Partition& partition, const Floor& floor, const KnownSpace& space, bool glimpse) const;
  std::unique_ptr<Look> look_at(const FloorRegion& region, const Partition& partition, const Floor& floor, const KnownSpace& space, bool glimpse, Looks& spare);
  std::vector<const Look*>::iterator place_of(const Look& look);

  RoomOptions options_;
  Looks looks_;                  ///< by rising number of the region
  News news_;
  std::vector<const Look*> listed_;  ///< those at rooms, by the rooms' first corners
};

std::vector<Room> find_rooms(const Partition& partition, const Floor& floor, const KnownSpace& space, const RoomOptions& options);

/// Fills in the two rooms each door joins.
void join_rooms(std::vector<Door>& doors, const std::vector<Room>& rooms);

/// Even-odd rule.
bool contains(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p);

}  // namespace modslam
