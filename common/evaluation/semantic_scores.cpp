// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/semantic_scores.hpp"

#include <set>

#include "common/evaluation/assignment.hpp"
#include "common/evaluation/statistics.hpp"

namespace modslam {
namespace {

constexpr double kTolerances_m[] = {0.05, 0.10, 0.20};
constexpr double kSameDirection_rad = 10 * kPi / 180;

double share(double part, double whole) { return whole > 0 ? part / whole : 0.0; }
double share(std::size_t part, std::size_t whole) {
  return share(static_cast<double>(part), static_cast<double>(whole));
}

bool same_direction(const MapWall& p, const MapWall& q) {
  const Eigen::Vector2d u = p.b - p.a, v = q.b - q.a;
  return std::abs(u.dot(v)) >= std::cos(kSameDirection_rad) * u.norm() * v.norm();
}

/// Distance from a wall's sample to the nearest wall of `others` that runs in its direction.
std::vector<double> distances(const std::vector<WallSample>& samples,
                              const std::vector<MapWall>& walls,
                              const std::vector<MapWall>& others) {
  std::vector<double> out(samples.size(), 1e9);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const MapWall& own = walls[samples[i].wall];
    // A thick wall is met at either of its faces.
    std::vector<Eigen::Vector2d> points = {samples[i].p};
    if (own.thickness_m > 0) {
      const Eigen::Vector2d along = (own.b - own.a).normalized();
      const Eigen::Vector2d to_face =
          Eigen::Vector2d(-along.y(), along.x()) * (own.thickness_m / 2);
      points = {samples[i].p + to_face, samples[i].p - to_face};
    }
    for (const MapWall& other : others) {
      if (!same_direction(own, other)) continue;
      for (const Eigen::Vector2d& p : points) out[i] = std::min(out[i], distance_to_wall(p, other));
    }
  }
  return out;
}

/// Of each of `found` (rows) with each of `truth`, by their polygons.
template <class Region>
Eigen::MatrixXd intersection_over_union(const std::vector<Region>& found, const std::vector<Region>& truth) {
  Eigen::MatrixXd iou(found.size(), truth.size());
  for (std::size_t f = 0; f < found.size(); ++f)
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const double overlap = overlap_m2(found[f].polygon, truth[t].polygon);
      iou(f, t) = share(overlap, area_m2(found[f].polygon) + area_m2(truth[t].polygon) - overlap);
    }
  return iou;
}

bool is_kind_of(const std::string& name, const std::string& general) {
  return name.size() >= general.size() && name.compare(name.size() - general.size(), general.size(), general) == 0;
}

}  // namespace

WallScores score_walls(const SemanticMap& found, const SemanticMap& truth,
                       const Visibility& visibility) {
  const auto found_samples = sample_walls(found.walls), truth_samples = sample_walls(truth.walls);
  const auto to_truth = distances(found_samples, found.walls, truth.walls);
  const auto to_found = distances(truth_samples, truth.walls, found.walls);
  WallScores scores;
  scores.found_segments = found.walls.size();
  scores.truth_segments = truth.walls.size();
  for (const WallSample& s : found_samples) scores.found_m += s.length_m;
  for (std::size_t i = 0; i < truth_samples.size(); ++i) {
    scores.truth_m += truth_samples[i].length_m;
    if (visibility.wall_samples[i]) scores.visible_m += truth_samples[i].length_m;
  }
  std::vector<double> errors_m;
  for (const double tolerance_m : kTolerances_m) {
    const double within_m = tolerance_m + 1e-9;  // a hair for rounding: the bound itself counts
    double right_m = 0, recalled_m = 0;
    errors_m.clear();
    for (std::size_t i = 0; i < found_samples.size(); ++i)
      if (to_truth[i] <= within_m)
        right_m += found_samples[i].length_m, errors_m.push_back(to_truth[i]);
    for (std::size_t i = 0; i < truth_samples.size(); ++i)
      if (visibility.wall_samples[i] && to_found[i] <= within_m)
        recalled_m += truth_samples[i].length_m;
    scores.at.push_back(
        {tolerance_m, {share(right_m, scores.found_m), share(recalled_m, scores.visible_m)}});
  }
  scores.median_error_m = statistics_of(errors_m).median;
  return scores;
}

RoomScores score_rooms(const SemanticMap& found, const SemanticMap& truth,
                       const Visibility& visibility) {
  constexpr double kExplored = 0.9, kSeen = 0.5, kMatch = 0.5;
  RoomScores scores;
  scores.found = found.rooms.size();
  scores.truth = truth.rooms.size();
  const Eigen::MatrixXd iou = intersection_over_union(found.rooms, truth.rooms);
  scores.truth_of_found = assign(-iou);
  std::vector<double> iou_of_truth(truth.rooms.size(), 0.0), matched_iou;
  for (std::size_t f = 0; f < found.rooms.size(); ++f) {
    int& t = scores.truth_of_found[f];
    if (t >= 0) iou_of_truth[t] = iou(f, t);
    if (t >= 0 && iou(f, t) >= kMatch) {
      matched_iou.push_back(iou(f, t));
      continue;
    }
    t = -1;
    if (visibility.from_run && visibility.seen.share(found.rooms[f].polygon, {}) < kSeen)
      ++scores.false_in_unseen;
  }
  scores.matched = matched_iou.size();
  scores.mean_matched_iou = statistics_of(matched_iou).mean;
  std::size_t recalled = 0;
  for (std::size_t t = 0; t < truth.rooms.size(); ++t) {
    if (visibility.rooms_explored[t] < kExplored) continue;
    ++scores.explored_truth;
    scores.mean_iou += iou_of_truth[t];
    if (iou_of_truth[t] >= kMatch) ++recalled;
  }
  scores.mean_iou = share(scores.mean_iou, static_cast<double>(scores.explored_truth));
  scores.at_half = {share(scores.matched, scores.found - scores.false_in_unseen),
                    share(recalled, scores.explored_truth)};
  return scores;
}

DoorScores score_doors(const SemanticMap& found, const SemanticMap& truth,
                       const Visibility& visibility, const RoomScores& rooms) {
  constexpr double kNear_m = 0.5, kFar = 1e3;
  DoorScores scores;
  scores.found = found.doors.size();
  scores.truth = truth.doors.size();
  Eigen::MatrixXd cost(found.doors.size(), truth.doors.size());
  for (std::size_t f = 0; f < found.doors.size(); ++f)
    for (std::size_t t = 0; t < truth.doors.size(); ++t) {
      const double apart_m = (found.doors[f].centre() - truth.doors[t].centre()).norm();
      cost(f, t) = apart_m <= kNear_m ? apart_m : kFar;
    }
  const std::vector<int> truth_of_found = assign(cost);

  const auto must_be_found = [&](std::size_t t) {
    return visibility.doors[t] && !truth.doors[t].closed;
  };
  for (std::size_t t = 0; t < truth.doors.size(); ++t) scores.visible_truth += must_be_found(t);

  // Names of found rooms in the words of the truth; a room that is none of the true ones is "?".
  const auto true_name = [&](const std::string& id) -> std::string {
    if (id.empty()) return "";
    for (std::size_t r = 0; r < found.rooms.size(); ++r)
      if (found.rooms[r].id == id)
        return rooms.truth_of_found[r] >= 0 ? truth.rooms[rooms.truth_of_found[r]].id : "?";
    return "?";
  };
  std::vector<double> distances_m, width_errors_m;
  std::size_t recalled = 0, strict = 0, strict_recalled = 0;
  for (std::size_t f = 0; f < found.doors.size(); ++f) {
    const int t = truth_of_found[f];
    if (t < 0 || cost(f, t) > kNear_m) continue;
    const MapDoor &door = found.doors[f], &true_door = truth.doors[t];
    distances_m.push_back(cost(f, t));
    width_errors_m.push_back(std::abs(door.width_m() - true_door.width_m()));
    recalled += must_be_found(t);
    const double straight_m =
        std::max((door.a - true_door.a).norm(), (door.b - true_door.b).norm());
    const double swapped_m = std::max((door.a - true_door.b).norm(), (door.b - true_door.a).norm());
    if (std::min(straight_m, swapped_m) <= kNear_m) ++strict, strict_recalled += must_be_found(t);
    if (!true_door.rooms_known) continue;
    ++scores.pairs_known;
    using Pair = std::multiset<std::string>;
    if (door.rooms_known && Pair{true_name(door.room_a), true_name(door.room_b)} ==
                                Pair{true_door.room_a, true_door.room_b})
      ++scores.pairs_right;
  }
  scores.matched = distances_m.size();
  scores.at_half_metre = {share(scores.matched, scores.found),
                          share(recalled, scores.visible_truth)};
  scores.strict = {share(strict, scores.found), share(strict_recalled, scores.visible_truth)};
  scores.median_distance_m = statistics_of(distances_m).median;
  scores.median_width_error_m = statistics_of(width_errors_m).median;
  return scores;
}

ObjectScores score_objects(const SemanticMap& found, const SemanticMap& truth) {
  constexpr double kMatch = 0.3;
  ObjectScores scores;
  scores.found = found.objects.size();
  scores.truth = truth.objects.size();
  const Eigen::MatrixXd iou = intersection_over_union(found.objects, truth.objects);
  const std::vector<int> truth_of_found = assign(-iou);
  for (std::size_t f = 0; f < found.objects.size(); ++f) {
    const int t = truth_of_found[f];
    if (t < 0 || iou(f, t) < kMatch) continue;
    ++scores.matched;
    const std::string& name = found.objects[f].class_name;
    if (name.empty()) continue;
    ++scores.named;
    scores.named_right += is_kind_of(truth.objects[t].class_name, name);
  }
  return scores;
}

SemanticScores score_semantics(const SemanticMap& found, const SemanticMap& truth,
                               const Visibility& visibility) {
  const RoomScores rooms = score_rooms(found, truth, visibility);
  return {score_walls(found, truth, visibility), score_wall_ends(found, truth), rooms, score_doors(found, truth, visibility, rooms), score_objects(found, truth)};
}

}  // namespace modslam
