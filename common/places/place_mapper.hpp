// SPDX-License-Identifier: BSD-3-Clause
/// @file Places of all nodes, in step with the pose graph: each is judged once, when its node is new; a loop closure only moves it.
#pragma once
#include <optional>
#include <vector>

#include "common/places/place_model.hpp"

namespace modslam {

class PlaceMapper {
 public:
  /// Without a model there are no places.
  explicit PlaceMapper(std::optional<PlaceModel> model) : model_(std::move(model)) {}

  /// Ids must come in order: 0, 1, 2, ... T_map_base: where it was when it was new.
  void add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base);
  /// Kind and confidence of each node, smoothed over the path; p is left to who knows the poses.
  /// @param on_map  what the semantic map says of each node; of those beyond its end it says nothing.
  std::vector<Place> places(const std::vector<PlaceOnMap>& on_map) const;
  void clear();

 private:
  std::optional<PlaceModel> model_;
  PanoramaMaker panorama_;
  std::vector<PlaceConfidence> seen_;
};

}  // namespace modslam
