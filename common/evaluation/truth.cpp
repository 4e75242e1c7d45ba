// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/truth.hpp"

#include <algorithm>
#include <stdexcept>

namespace modslam {
namespace {

constexpr double kMaxGap_s = 1.0;
constexpr double kDegrees = 180.0 / kPi;

std::optional<Pose2> truth_at(const Path& truth, double stamp_s) {
  const auto after = std::lower_bound(truth.begin(), truth.end(), stamp_s,
                                      [](const StampedPose& p, double s) { return p.stamp_s < s; });
  if (after == truth.end()) return std::nullopt;
  if (after->stamp_s == stamp_s) return after->pose;
  if (after == truth.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double gap_s = after->stamp_s - before->stamp_s;
  if (gap_s > kMaxGap_s) return std::nullopt;
  return interpolate(before->pose, after->pose, (stamp_s - before->stamp_s) / gap_s);
}

}  // namespace

std::vector<PosePair> pair_with_truth(const Path& estimate, Path truth, std::size_t* unpaired) {
  std::stable_sort(truth.begin(), truth.end(), [](const StampedPose& a, const StampedPose& b) {
    return a.stamp_s < b.stamp_s;
  });
  std::vector<PosePair> pairs;
  if (unpaired) *unpaired = 0;
  for (const StampedPose& p : estimate) {
    if (const auto true_pose = truth_at(truth, p.stamp_s))
      pairs.push_back({p.stamp_s, *true_pose, p.pose});
    else if (unpaired)
      ++*unpaired;
  }
  return pairs;
}

Pose2 align_first(const std::vector<PosePair>& pairs) {
  return pairs.front().T_world_base * pairs.front().T_map_base.inverse();
}

Pose2 align_least_squares(const std::vector<PosePair>& pairs) {
  Eigen::Vector2d mean_world = Eigen::Vector2d::Zero(), mean_map = Eigen::Vector2d::Zero();
  for (const PosePair& p : pairs) {
    mean_world += p.T_world_base.translation();
    mean_map += p.T_map_base.translation();
  }
  mean_world /= static_cast<double>(pairs.size());
  mean_map /= static_cast<double>(pairs.size());
  double along = 0, across = 0;  // sums of dot and cross products: their angle is the best turn
  for (const PosePair& p : pairs) {
    const Eigen::Vector2d m = p.T_map_base.translation() - mean_map,
                          w = p.T_world_base.translation() - mean_world;
    along += m.dot(w);
    across += m.x() * w.y() - m.y() * w.x();
  }
  const double turn_rad =
      std::hypot(along, across) > 1e-9 ? std::atan2(across, along) : align_first(pairs).heading;
  const Eigen::Vector2d t = mean_world - rotation(turn_rad) * mean_map;
  return {t.x(), t.y(), turn_rad};
}

AbsoluteError absolute_error(const std::vector<PosePair>& pairs, const Pose2& T_world_map) {
  AbsoluteError e;
  e.T_world_map = T_world_map;
  std::vector<double> headings_deg;
  for (const PosePair& p : pairs) {
    const Pose2 placed = T_world_map * p.T_map_base;
    e.stamps_s.push_back(p.stamp_s);
    e.positions_m.push_back(distance(placed, p.T_world_base));
    e.headings_deg.push_back(wrap_angle(placed.heading - p.T_world_base.heading) * kDegrees);
    headings_deg.push_back(std::abs(e.headings_deg.back()));
  }
  e.position_m = statistics_of(e.positions_m);
  e.heading_deg = statistics_of(headings_deg);
  return e;
}

RelativeError relative_error(const std::vector<PosePair>& pairs, double travelled_m) {
  std::vector<double> odometer_m, translation_m, rotation_deg;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    odometer_m.push_back(i == 0 ? 0
                                : odometer_m.back() +
                                      distance(pairs[i - 1].T_world_base, pairs[i].T_world_base));
  std::size_t end = 0;
  for (std::size_t start = 0; start < pairs.size(); ++start) {
    while (end < pairs.size() && odometer_m[end] < odometer_m[start] + travelled_m) ++end;
    if (end == pairs.size()) break;
    const Pose2 error = between(between(pairs[start].T_world_base, pairs[end].T_world_base),
                                between(pairs[start].T_map_base, pairs[end].T_map_base));
    translation_m.push_back(error.translation().norm());
    rotation_deg.push_back(std::abs(error.heading) * kDegrees);
  }
  return {travelled_m, statistics_of(translation_m), statistics_of(rotation_deg)};
}

TruthScores score_against_truth(const Path& T_map_base, const Path& truth) {
  TruthScores scores;
  const std::vector<PosePair> pairs = pair_with_truth(T_map_base, truth, &scores.unpaired);
  if (pairs.empty()) throw std::runtime_error("no pose of the path has a true pose at its time");
  scores.first_pose = absolute_error(pairs, align_first(pairs));
  scores.least_squares = absolute_error(pairs, align_least_squares(pairs));
  for (const double travelled_m : {1.0, 5.0, 10.0})
    scores.relative.push_back(relative_error(pairs, travelled_m));
  return scores;
}

}  // namespace modslam
