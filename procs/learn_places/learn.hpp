// SPDX-License-Identifier: BSD-3-Clause
/// @file Learning which places look how, and how well it goes on buildings that were not learned from.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "common/places/place_model.hpp"

namespace modslam {

struct LabelledDrive {
  std::string laser;
  PlacePath path;
};

/// All drives through one building.
struct Building {
  std::string name;
  std::vector<LabelledDrive> drives;
  std::vector<PlacePath> scaled;  ///< of the building drawn larger and smaller: learned from, never scored
};

/// counts[is][said]
struct Confusion {
  std::array<std::array<std::int64_t, kPlaceKinds>, kPlaceKinds> counts{};
  std::int64_t total() const;
  double accuracy() const;  ///< 0 without a count
  double recall(PlaceKind kind) const;
  double precision(PlaceKind kind) const;
  void add(const Confusion& other);
};

struct BuildingScore {
  std::string name;
  Confusion alone, smoothed, told;         ///< each node by itself, with its path, and with what the map says too
  std::map<std::string, Confusion> of_laser;  ///< with all of it
};

/// A model from all buildings but `left_out`, and from made-up ones.
PlaceModel learn(const std::vector<Building>& buildings, const std::vector<PlacePath>& made_up, const Building* left_out);

/// A model for each building from all the others, scored on it.
std::vector<BuildingScore> score_held_out(const std::vector<Building>& buildings, const std::vector<PlacePath>& made_up);

BuildingScore score(const PlaceModel& model, const Building& building);

/// For people and docs/benchmarks.md; for programs.
std::string scores_markdown(const std::vector<BuildingScore>& scores);
std::string scores_json(const std::vector<BuildingScore>& scores);

}  // namespace modslam
