// SPDX-License-Identifier: BSD-3-Clause
/// @file What is hidden in rooms: inside of them, off their outlines, and no floor.
#pragma once
#include "common/semantics/floor.hpp"
#include "common/semantics/plan_index.hpp"
#include "common/semantics/room_finder.hpp"
#include "common/semantics/slots.hpp"

namespace modslam {

/// Keeps the picture in step with rooms and floor.
class HiddenSpace {
 public:
  /// @param open  where the floor changed. @return where the picture did.
  Boxes update(const RoomMap::News& rooms, const KnownSpace& space, const Floor& floor, const Boxes& open);
  void grow(const Growth& growth) { picture_ = grown(picture_, growth, 0); }
  bool contains(const cv::Point& cell) const { return picture_(cell) > 0; }

 private:
  void take(const RoomMap::News& rooms);

  static constexpr double kSquare_m = 6.4;
  cv::Mat1b picture_;
  Slots<Corners> outlines_;   ///< of rooms
  PlanIndex index_{kSquare_m};
};

}  // namespace modslam
