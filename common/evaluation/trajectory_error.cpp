// SPDX-License-Identifier: BSD-3-Clause
#include "common/evaluation/trajectory_error.hpp"

#include <algorithm>

namespace modslam {

std::vector<TruthPair> pair_path_with_truth(const std::vector<PathPose>& path,
                                            std::vector<PathPose> truth, std::int64_t max_gap_us) {
  const auto earlier = [](const PathPose& a, const PathPose& b) { return a.utime < b.utime; };
  std::stable_sort(truth.begin(), truth.end(), earlier);
  std::vector<TruthPair> pairs;
  for (const PathPose& p : path) {
    const auto after = std::lower_bound(truth.begin(), truth.end(), p, earlier);
    if (after == truth.end()) continue;
    if (after->utime == p.utime) {
      pairs.push_back({p.utime, p.pose, after->pose});
      continue;
    }
    if (after == truth.begin()) continue;
    const auto before = after - 1;
    const double gap_us = static_cast<double>(after->utime - before->utime);
    if (gap_us > static_cast<double>(max_gap_us)) continue;
    const double share = static_cast<double>(p.utime - before->utime) / gap_us;
    pairs.push_back({p.utime, p.pose, interpolate(before->pose, after->pose, share)});
  }
  return pairs;
}

std::optional<Pose2> lay_by_first_pose(const std::vector<TruthPair>& pairs) {
  if (pairs.empty()) return std::nullopt;
  return pairs[0].T_world_base * pairs[0].T_map_base.inverse();
}

std::optional<Pose2> lay_by_least_squares(const std::vector<TruthPair>& pairs) {
  if (pairs.empty()) return std::nullopt;
  Eigen::Vector2d mean_map = Eigen::Vector2d::Zero(), mean_world = mean_map;
  for (const TruthPair& p : pairs)
    mean_map += p.T_map_base.translation(), mean_world += p.T_world_base.translation();
  mean_map /= static_cast<double>(pairs.size());
  mean_world /= static_cast<double>(pairs.size());
  double dot = 0, cross = 0;
  for (const TruthPair& p : pairs) {
    const Eigen::Vector2d a = p.T_map_base.translation() - mean_map,
                          b = p.T_world_base.translation() - mean_world;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
  }
  if (std::hypot(dot, cross) < 1e-9 * static_cast<double>(pairs.size()))
    return lay_by_first_pose(pairs);
  const double heading = std::atan2(cross, dot);
  const Eigen::Vector2d t = mean_world - rotation(heading) * mean_map;
  return Pose2(t.x(), t.y(), heading);
}

PathError path_error(const std::vector<TruthPair>& pairs, const Pose2& T_world_map) {
  PathError error;
  for (const TruthPair& p : pairs) {
    const Pose2 T_world_base = T_world_map * p.T_map_base;
    error.position_m.push_back(distance(T_world_base, p.T_world_base));
    error.heading_rad.push_back(
        std::abs(wrap_angle(T_world_base.heading - p.T_world_base.heading)));
  }
  return error;
}

ErrorFigures figures(const std::vector<double>& errors) {
  ErrorFigures f;
  if (errors.empty()) return f;
  double squares = 0;
  for (double e : errors) f.mean += e, squares += e * e, f.max = std::max(f.max, e);
  f.mean /= static_cast<double>(errors.size());
  f.rms = std::sqrt(squares / static_cast<double>(errors.size()));
  return f;
}

}  // namespace modslam
