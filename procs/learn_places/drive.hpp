// SPDX-License-Identifier: BSD-3-Clause
/// @file Labelled places from simulated drives: a world's tour, a laser, and what the world says each node is.
#pragma once
#include "common/places/place_model.hpp"
#include "common/world/laser_noise.hpp"
#include "common/world/world.hpp"

namespace modslam {

/// In a doorway within 0.4 m of the line between its jambs; else what the room is that it stands in (a plan's HALL is a room). False: in no room.
bool place_in(const World& world, const Eigen::Vector2d& p, PlaceKind& kind);

/// The world with boxes of furniture in its rooms, clear of the tour and of the doors.
World furnished(World world, const Route& tour, std::uint64_t seed);

/// How a world is driven through.
struct DriveOptions {
  LaserConfig laser;
  double scale = 1;        ///< everything is so many times as large as drawn
  std::uint64_t seed = 1;
};

/// Drives the tour; every 0.3 m or 0.35 rad a node, as the estimator has them. Nodes in no room are left out.
PlacePath drive(const World& world, const Route& tour, const DriveOptions& options);

}  // namespace modslam
