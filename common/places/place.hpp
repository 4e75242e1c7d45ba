// SPDX-License-Identifier: BSD-3-Clause
/// @file What kind of place a node of the pose graph is.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace modslam {

enum class PlaceKind : std::uint8_t { kRoom = 0, kCorridor = 1, kDoorway = 2 };
inline constexpr std::size_t kPlaceKinds = 3;

/// One number a kind, in the order of PlaceKind. Confidences are 0..1 and sum to 1.
using PlaceConfidence = std::array<double, kPlaceKinds>;

/// What the semantic map says of a place: nothing, or where it lies in it.
enum class PlaceHint : std::uint8_t { kNone = 0, kInRoom = 1, kInCorridor = 2, kAtDoor = 3 };
inline constexpr std::size_t kPlaceHints = 4;

struct PlaceOnMap {
  PlaceHint hint = PlaceHint::kNone;
  int room = -1;           ///< any number that all places in one room or corridor have; -1: in none
};

struct Place {
  std::int64_t node = 0;   ///< id of the node
  Eigen::Vector2d p{0, 0}; ///< where it is [m], map frame
  PlaceKind kind = PlaceKind::kRoom;
  double confidence = 0;   ///< 0..1, with what the map says, after smoothing over the path
};

/// "room", "corridor", "doorway".
const char* place_name(PlaceKind kind);

}  // namespace modslam
