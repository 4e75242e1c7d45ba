// SPDX-License-Identifier: BSD-3-Clause
/// @file Which kind of place a panorama shows: one boosted classifier a kind (AdaBoost, OpenCV), and how kinds follow each other on a path.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "common/places/panorama.hpp"
#include "common/places/place.hpp"

namespace modslam {

/// probability[from][to]: from one node of a path to the next; rows sum to 1.
using PlaceTransitions = std::array<PlaceConfidence, kPlaceKinds>;

/// What a place looked like and what it is; in the order of a path.
struct PlaceSample {
  std::vector<float> features;
  PlaceKind kind = PlaceKind::kRoom;
  PlaceOnMap on_map;        ///< after the whole path
};
using PlacePath = std::vector<PlaceSample>;

class PlaceModel {
 public:
  /// @throws std::runtime_error when the text (YAML) is no model of this program.
  static PlaceModel parse(const std::string& text);
  /// Learns from labelled paths. @throws std::invalid_argument when a kind is missing in them.
  static PlaceModel train(const std::vector<PlacePath>& paths);
  std::string text() const;

  /// How sure each kind is; equal shares where hardly anything was seen.
  PlaceConfidence confidence(const Panorama& panorama) const;
  PlaceConfidence confidence(const std::vector<float>& features) const;
  /// How likely the map says that of places of each kind.
  const PlaceConfidence& likelihood(PlaceHint hint) const { return hints_[static_cast<std::size_t>(hint)]; }
  const PlaceTransitions& transitions() const { return transitions_; }

 private:
  struct Boosts;
  std::shared_ptr<const Boosts> boosts_;
  PlaceTransitions transitions_{};
  std::array<PlaceConfidence, kPlaceHints> hints_{};  ///< probability[hint][kind]: of the hint at a place of that kind
};

}  // namespace modslam
