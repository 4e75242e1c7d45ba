// SPDX-License-Identifier: BSD-3-Clause
/// @file From evidence to walls, rooms, doors and objects: the same for a run and for a finished map.
#pragma once
#include <functional>
#include <set>

#include "common/semantics/door_map.hpp"
#include "common/semantics/furniture.hpp"
#include "common/semantics/hidden_space.hpp"
#include "common/semantics/object_finder.hpp"
#include "common/semantics/room_finder.hpp"
#include "common/semantics/semantics_config.hpp"
#include "common/semantics/wall_ends.hpp"
#include "common/semantics/wall_list.hpp"
#include "common/semantics/wall_map.hpp"

namespace modslam {

/// Keeps the layers in step with the evidence. Every stage is told where the one before it changed, and works out anew what depends on that; the result is
/// the one of an interpreter that sees the same evidence for the first time.
class Interpreter {
 public:
  using LogOdds = std::function<double(const Eigen::Vector2d&)>;

  explicit Interpreter(const SemanticsConfig& config, OpeningModel::Kind kind = OpeningModel::Kind::kSensed);

  /// What a scan showed, map frame; sign -1 takes it back.
  void add(const Segment& segment, int sign) { found_walls_.add(segment, sign); }
  void add(const DoorSighting& sighting, int sign) { sightings_.add(sighting, sign); }

  /// @param changed  cells of the space, @param odds_changed  plan_box()es of the log-odds that changed since the last call. @param layers  as the last
  /// call left them, but for ids. Walls that stay keep their ids; all else comes without. @return walls that went.
  std::vector<Wall> update(const KnownSpace& space, const Boxes& changed, const LogOdds& wall_log_odds, const Boxes& odds_changed, SemanticLayers& layers);

 private:
  void follow(const KnownSpace& space);
  WallMap::News find_walls(const KnownSpace& space, const Boxes& changed, const LogOdds& wall_log_odds, Boxes odds_changed);
  std::vector<bool> pieces_of_wall(const KnownSpace& space) const;
  NumberNews take_faces(const WallMap::News& found, const std::vector<bool>& dropped, const KnownSpace& space);
  NumberNews take_walls(const NumberNews& faces, const KnownSpace& space, const Boxes& changed);
  std::vector<Wall> list_walls(const Numbers& doubtful, const Numbers& altered, const KnownSpace& space, std::vector<Wall>& walls);
  Numbers find_hiding(const KnownSpace& space, const Boxes& open, const NumberNews& news);

  SemanticsConfig config_;
  cv::Rect frame_;                  ///< of the space in its lattice, when it was last seen
  WallMap found_walls_;
  std::set<std::size_t> on_objects_;  ///< those of them that stand on an object
  bool pieces_stood_ = false;         ///< some objects were pieces of wall in the last round
  DoorSightings sightings_;
  Floor floor_;
  ObjectMap objects_;
  OpeningMap openings_;
  FloorParter parter_;
  RoomMap rooms_;
  FurnitureMap furniture_;          ///< among walls that stand on no object
  WallSet known_walls_;             ///< those that are not, before those in rooms are dropped
  WallEnds wall_ends_;              ///< of these
  HiddenSpace hidden_;
  std::vector<char> hides_;         ///< by number of the wall: stands before what is hidden
  WallList list_;                   ///< of those that do not
};

}  // namespace modslam
