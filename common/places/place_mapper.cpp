// SPDX-License-Identifier: BSD-3-Clause
#include "common/places/place_mapper.hpp"

#include <algorithm>

#include "common/places/place_smoother.hpp"

namespace modslam {

void PlaceMapper::add_node(const Scan& scan, const SensorInfo& sensor, const Pose2& T_map_base) {
  if (model_) seen_.push_back(model_->confidence(panorama_.add(scan, sensor, T_map_base)));
}

void PlaceMapper::clear() {
  panorama_.clear();
  seen_.clear();
}

std::vector<Place> PlaceMapper::places(const std::vector<PlaceOnMap>& on_map) const {
  std::vector<Place> out;
  if (!model_) return out;
  for (const PlaceConfidence& p : smooth_places(seen_, model_->transitions(), told_by_map(seen_, on_map, *model_))) {
    const auto best = std::max_element(p.begin(), p.end());
    Place place;
    place.node = static_cast<std::int64_t>(out.size());
    place.kind = static_cast<PlaceKind>(best - p.begin());
    place.confidence = *best;
    out.push_back(place);
  }
  return out;
}

}  // namespace modslam
