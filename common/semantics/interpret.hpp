// SPDX-License-Identifier: BSD-3-Clause
/// @file From evidence to walls, rooms, doors and objects: the same for a run and for a finished map.
#pragma once
#include <functional>

#include "common/semantics/door_map.hpp"
#include "common/semantics/furniture.hpp"
#include "common/semantics/object_finder.hpp"
#include "common/semantics/room_finder.hpp"
#include "common/semantics/semantics_config.hpp"
#include "common/semantics/wall_ends.hpp"
#include "common/semantics/wall_map.hpp"

namespace modslam {

/// Keeps the layers in step with the evidence. Every stage is told where the one before it changed, and works out anew what depends on that; the result is
/// the one of an interpreter that sees the same evidence for the first time.
class Interpreter {
 public:
  using LogOdds = std::function<double(const Eigen::Vector2d&)>;

  explicit Interpreter(const SemanticsConfig& config, OpeningModel::Kind kind = OpeningModel::Kind::kSensed);

  /// What a scan showed, map frame; sign -1 takes it back.
  void add(const Segment& segment, int sign) { walls_.add(segment, sign); }
  void add(const DoorSighting& sighting, int sign) { sightings_.add(sighting, sign); }

  /// @param changed  cells of the space, @param odds_changed  plan_box()es of the log-odds that changed since the last call. Ids are left 0.
  SemanticLayers update(const KnownSpace& space, const Boxes& changed, const LogOdds& wall_log_odds, const Boxes& odds_changed);

 private:
  using Bands = std::vector<const WallBand*>;
  void follow(const KnownSpace& space);
  Bands find_bands(const KnownSpace& space, const Boxes& changed, const LogOdds& wall_log_odds, Boxes odds_changed);
  std::vector<bool> find_furniture(const std::vector<Wall>& faces, const KnownSpace& space, const Boxes& changed);
  Boxes take_walls(const std::vector<Wall>& walls, const KnownSpace& space, WallSet::News& news);
  Boxes find_hidden(const std::vector<Room>& rooms, const KnownSpace& space, const Boxes& open);
  void drop_faces_in_rooms(SemanticLayers& layers, const KnownSpace& space, const Boxes& open, const WallSet::News& news);

  SemanticsConfig config_;
  cv::Rect frame_;                  ///< of the space in its lattice, when it was last seen
  WallMap walls_;
  DoorSightings sightings_;
  Floor floor_;
  ObjectMap objects_;
  OpeningMap openings_;
  FloorParter parter_;
  RoomMap rooms_;
  FurnitureMap furniture_;
  WallSet known_walls_;             ///< without furniture, before those in rooms are dropped
  WallEnds wall_ends_;              ///< of these
  struct Ring {
    std::vector<Eigen::Vector2d> outline;
    cv::Rect box;                   ///< of cells around it
    bool stays = true;              ///< in this round
  };
  std::map<int, Ring> known_rings_; ///< of rooms, by region
  cv::Mat1b hidden_;                ///< inside rooms, off their outlines, and no floor
  std::vector<char> hides_;         ///< by number of the wall: stands before what is hidden
};

}  // namespace modslam
