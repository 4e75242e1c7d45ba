// SPDX-License-Identifier: BSD-3-Clause
#include "procs/learn_places/learn.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/places/place_smoother.hpp"

namespace modslam {
namespace {

constexpr std::array<PlaceKind, kPlaceKinds> kKinds = {PlaceKind::kRoom, PlaceKind::kCorridor, PlaceKind::kDoorway};

double ratio(std::int64_t part, std::int64_t whole) { return whole ? static_cast<double>(part) / static_cast<double>(whole) : 0.0; }

std::string percent(double share) {
  char words[16];
  std::snprintf(words, sizeof words, "%.1f", 100 * share);
  return words;
}

void count(const std::vector<PlaceConfidence>& said, const PlacePath& path, Confusion& confusion) {
  for (std::size_t k = 0; k < path.size(); ++k) {
    const auto best = std::max_element(said[k].begin(), said[k].end()) - said[k].begin();
    ++confusion.counts[static_cast<std::size_t>(path[k].kind)][static_cast<std::size_t>(best)];
  }
}

BuildingScore pooled(const std::vector<BuildingScore>& scores) {
  BuildingScore all{"**all**", {}, {}, {}, {}};
  for (const BuildingScore& s : scores) {
    all.alone.add(s.alone);
    all.smoothed.add(s.smoothed);
    all.told.add(s.told);
    for (const auto& [laser, confusion] : s.of_laser) all.of_laser[laser].add(confusion);
  }
  return all;
}

}  // namespace

std::int64_t Confusion::total() const {
  std::int64_t sum = 0;
  for (const auto& row : counts)
    for (const std::int64_t n : row) sum += n;
  return sum;
}

double Confusion::accuracy() const { return ratio(counts[0][0] + counts[1][1] + counts[2][2], total()); }

double Confusion::recall(PlaceKind kind) const {
  const auto& row = counts[static_cast<std::size_t>(kind)];
  return ratio(row[static_cast<std::size_t>(kind)], row[0] + row[1] + row[2]);
}

double Confusion::precision(PlaceKind kind) const {
  const auto k = static_cast<std::size_t>(kind);
  return ratio(counts[k][k], counts[0][k] + counts[1][k] + counts[2][k]);
}

void Confusion::add(const Confusion& other) {
  for (std::size_t is = 0; is < kPlaceKinds; ++is)
    for (std::size_t said = 0; said < kPlaceKinds; ++said) counts[is][said] += other.counts[is][said];
}

BuildingScore score(const PlaceModel& model, const Building& building) {
  BuildingScore out{building.name, {}, {}, {}, {}};
  for (const auto& [laser, path] : building.drives) {
    std::vector<PlaceConfidence> seen;
    std::vector<PlaceOnMap> on_map;
    for (const PlaceSample& sample : path) {
      seen.push_back(model.confidence(sample.features));
      on_map.push_back(sample.on_map);
    }
    count(seen, path, out.alone);
    count(smooth_places(seen, model.transitions(), {}), path, out.smoothed);
    count(smooth_places(seen, model.transitions(), told_by_map(seen, on_map, model)), path, out.of_laser[laser]);
  }
  for (const auto& [laser, confusion] : out.of_laser) out.told.add(confusion);
  return out;
}

PlaceModel learn(const std::vector<Building>& buildings, const std::vector<PlacePath>& made_up, const Building* left_out) {
  std::vector<PlacePath> paths = made_up;
  for (const Building& building : buildings) {
    if (&building == left_out) continue;
    for (const LabelledDrive& drive : building.drives) paths.push_back(drive.path);
    paths.insert(paths.end(), building.scaled.begin(), building.scaled.end());
  }
  return PlaceModel::train(paths);
}

std::vector<BuildingScore> score_held_out(const std::vector<Building>& buildings, const std::vector<PlacePath>& made_up) {
  std::vector<BuildingScore> scores;
  for (const Building& held_out : buildings) scores.push_back(score(learn(buildings, made_up, &held_out), held_out));
  return scores;
}

std::string scores_markdown(const std::vector<BuildingScore>& scores) {
  std::ostringstream out;
  out << "| building held out | nodes | accuracy, each node alone | smoothed over the path | and with the map | room R | corridor R | doorway R | doorway P |\n"
      << "|---|---|---|---|---|---|---|---|---|\n";
  std::vector<BuildingScore> rows = scores;
  const BuildingScore all = pooled(scores);
  rows.push_back(all);
  for (const BuildingScore& s : rows)
    out << "| " << s.name << " | " << s.alone.total() << " | " << percent(s.alone.accuracy()) << " | " << percent(s.smoothed.accuracy()) << " | " << percent(s.told.accuracy()) << " | "
        << percent(s.told.recall(PlaceKind::kRoom)) << " | " << percent(s.told.recall(PlaceKind::kCorridor)) << " | "
        << percent(s.told.recall(PlaceKind::kDoorway)) << " | " << percent(s.told.precision(PlaceKind::kDoorway)) << " |\n";
  out << "\n| laser | accuracy, smoothed, with the map |\n|---|---|\n";
  for (const auto& [laser, confusion] : all.of_laser) out << "| " << laser << " | " << percent(confusion.accuracy()) << " |\n";
  out << "\nOf all these nodes, smoothed and with the map, in per cent of each row:\n\n| is \\ said | room | corridor | doorway |\n|---|---|---|---|\n";
  for (const PlaceKind is : kKinds) {
    const auto& row = all.told.counts[static_cast<std::size_t>(is)];
    out << "| " << place_name(is);
    for (const std::int64_t n : row) out << " | " << percent(ratio(n, row[0] + row[1] + row[2]));
    out << " |\n";
  }
  return out.str();
}

std::string scores_json(const std::vector<BuildingScore>& scores) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  std::vector<BuildingScore> rows = scores;
  rows.push_back(pooled(scores));
  rows.back().name = "all";
  for (const BuildingScore& s : rows)
    out.push_back({{"building", s.name},
                   {"nodes", s.alone.total()},
                   {"accuracy_alone", s.alone.accuracy()},
                   {"accuracy_smoothed", s.smoothed.accuracy()},
                   {"accuracy_with_map", s.told.accuracy()},
                   {"confusion_alone", s.alone.counts},
                   {"confusion_smoothed", s.smoothed.counts},
                   {"confusion_with_map", s.told.counts}});
  return out.dump(1) + "\n";
}

}  // namespace modslam
