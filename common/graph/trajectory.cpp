// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/trajectory.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>

#include "common/graph/components.hpp"

namespace modslam {
namespace {

/// What a step costs when the correction is handed out: its way, half a metre a radian for turning,
/// and a millimetre for itself so that a robot that stands still is no special case.
double effort(const Pose2& T_node_before, const Pose2& T_node_after) {
  return distance(T_node_before, T_node_after) +
         0.5 * std::abs(wrap_angle(T_node_after.heading - T_node_before.heading)) + 0.001;
}

/// Poses of one span: tracked[begin, end) all hang on one node.
/// @param next the scan behind it when that one says where it hung on the same node, and its final pose.
void place_span(const std::vector<TrackedPose>& tracked, std::size_t begin, std::size_t end,
                const Pose2& T_map_node, const TrackedPose* next, const Pose2& T_map_next,
                std::vector<Pose2>& path) {
  std::vector<double> spent;
  double total = 0;
  for (std::size_t i = begin; i < end; ++i) {
    if (i > begin) total += effort(tracked[i - 1].T_node_base, tracked[i].T_node_base);
    spent.push_back(total);
  }
  Pose2 correction;
  if (next) {
    correction = between(T_map_node * next->T_before_base, T_map_next);
    total += effort(tracked[end - 1].T_node_base, next->T_before_base);
  }
  for (std::size_t i = begin; i < end; ++i) {
    const double share = total > 0 ? spent[i - begin] / total : 0;
    path[i] = T_map_node * tracked[i].T_node_base * interpolate({}, correction, share);
  }
}

}  // namespace

std::vector<Pose2> final_path(const std::vector<TrackedPose>& tracked,
                              const std::map<NodeId, Pose2>& T_map_node) {
  std::vector<Pose2> path(tracked.size());
  for (std::size_t begin = 0, end; begin < tracked.size(); begin = end) {
    const NodeId node = tracked[begin].node;
    for (end = begin + 1; end < tracked.size() && tracked[end].node == node && tracked[end].node_before < 0;) ++end;
    const auto pose = T_map_node.find(node);
    if (pose == T_map_node.end()) {
      for (std::size_t i = begin; i < end; ++i) path[i] = tracked[i].T_map_base;
      continue;
    }
    const TrackedPose* next = end < tracked.size() && tracked[end].node_before == node ? &tracked[end] : nullptr;
    const auto pose_next = next ? T_map_node.find(next->node) : T_map_node.end();
    if (pose_next == T_map_node.end())
      place_span(tracked, begin, end, pose->second, nullptr, {}, path);
    else
      place_span(tracked, begin, end, pose->second, next, pose_next->second * next->T_node_base, path);
  }
  return path;
}

void add_lost_nodes(std::vector<TrackedPose>& tracked, const std::map<NodeId, std::int64_t>& node_utimes,
                    const std::map<EdgeId, GraphEdge>& edges) {
  std::set<std::pair<NodeId, std::int64_t>> told;
  for (const TrackedPose& pose : tracked) told.emplace(pose.node, pose.utime);
  std::map<NodeId, GraphEdge> from_before;
  for (const auto& [id, edge] : edges)
    if (edge.kind == EdgeKind::kSequence && edge.from < edge.to && !is_break(edge)) from_before.emplace(edge.to, edge);
  for (const auto& [id, utime] : node_utimes) {
    const auto edge = from_before.find(id);
    if (edge == from_before.end() || told.count({id, utime})) continue;
    TrackedPose lost;
    lost.utime = utime;
    lost.node = id;
    lost.node_before = edge->second.from;
    lost.T_before_base = edge->second.T_from_to;
    const NodeId node = id;
    auto behind = std::find_if(tracked.begin(), tracked.end(), [node](const TrackedPose& pose) { return pose.node == node; });
    if (behind == tracked.end())
      behind = std::find_if(tracked.begin(), tracked.end(), [node](const TrackedPose& pose) { return pose.node > node; });
    tracked.insert(behind, lost);
  }
}

std::vector<int> match_in_order(const std::vector<std::int64_t>& scan_utimes,
                                const std::vector<std::int64_t>& pose_utimes) {
  std::unordered_map<std::int64_t, std::vector<std::size_t>> scans_at;
  for (std::size_t i = 0; i < scan_utimes.size(); ++i) scans_at[scan_utimes[i]].push_back(i);
  std::vector<int> pose_of_scan(scan_utimes.size(), -1);
  std::size_t first = 0;  // scans before it are settled
  for (std::size_t p = 0; p < pose_utimes.size(); ++p) {
    const auto same = scans_at.find(pose_utimes[p]);
    if (same == scans_at.end()) continue;
    const auto scan = std::lower_bound(same->second.begin(), same->second.end(), first);
    if (scan == same->second.end()) continue;
    pose_of_scan[*scan] = static_cast<int>(p);
    first = *scan + 1;
  }
  return pose_of_scan;
}

std::vector<Pose2> fill_by_index(const std::vector<int>& pose_of_scan,
                                 const std::vector<Pose2>& poses) {
  std::vector<Pose2> filled(pose_of_scan.size());
  const auto pose = [&](std::size_t scan) {
    return poses[static_cast<std::size_t>(pose_of_scan[scan])];
  };
  std::size_t known = filled.size();  // the last scan with a pose so far
  for (std::size_t i = 0; i < filled.size(); ++i) {
    if (pose_of_scan[i] < 0) continue;
    filled[i] = pose(i);
    const bool first = known == filled.size();
    for (std::size_t j = first ? 0 : known + 1; j < i; ++j)
      filled[j] =
          first ? filled[i]
                : interpolate(filled[known], filled[i],
                              static_cast<double>(j - known) / static_cast<double>(i - known));
    known = i;
  }
  if (known == filled.size()) return {};
  std::fill(filled.begin() + static_cast<std::ptrdiff_t>(known) + 1, filled.end(), filled[known]);
  return filled;
}

}  // namespace modslam
