// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/results.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/formats/g2o_writer.hpp"

namespace modslam::report {
namespace {

constexpr int kMapMargin_cells = 10;

void measure_time(const RunRecord& run, Results& out) {
  const auto& t = run.laser_utimes;
  if (t.empty()) return;
  const auto [first, last] = std::minmax_element(t.begin(), t.end());
  out.start_utime = *first;
  out.duration_s = seconds_between(*first, *last);
  for (std::size_t i = 1; i < t.size(); ++i) out.stamps_stepped_back += t[i] < t[i - 1];
}

void assemble_path(const RunRecord& run, Results& out) {
  out.nodes = run.graph.poses();
  const std::vector<Pose2> poses = final_path(run.poses, out.nodes);
  std::vector<std::int64_t> pose_utimes;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    pose_utimes.push_back(run.poses[i].utime);
    out.path.push_back({run.poses[i].utime, poses[i]});
    if (i > 0) out.path_length_m += distance(poses[i - 1], poses[i]);
  }
  const std::vector<int> pose_of_scan = match_in_order(run.laser_utimes, pose_utimes);
  out.scans_without_pose = std::count(pose_of_scan.begin(), pose_of_scan.end(), -1);
  out.poses_without_scan =
      static_cast<std::int64_t>(poses.size() - pose_of_scan.size()) + out.scans_without_pose;

  const Pose2 T_base_laser = run.graph.sensor() ? run.graph.sensor()->T_base_laser
                             : run.sensor       ? run.sensor->T_base_laser
                                                : Pose2();
  const std::vector<Pose2> filled = fill_by_index(pose_of_scan, poses);
  for (std::size_t i = 0; i < filled.size(); ++i)
    out.path_laser.push_back({run.laser_utimes[i], filled[i] * T_base_laser});
}

void assemble_map(const RunRecord& run, Results& out) {
  std::vector<MapTile> tiles;
  for (const auto& [place, tile] : run.tiles) tiles.push_back(tile);
  try {
    out.map = join_tiles(tiles, kMapMargin_cells);
  } catch (const std::runtime_error& error) {
    out.map_trouble = error.what();
  }
  const auto unknown = std::count(out.map.cells.begin(), out.map.cells.end(), 0);
  out.known_area_m2 =
      static_cast<double>(static_cast<std::int64_t>(out.map.cells.size()) - unknown) *
      out.map.resolution_m * out.map.resolution_m;
}

Path in_seconds(const std::vector<PathPose>& poses) {
  Path out;
  for (const PathPose& p : poses) out.push_back({1e-6 * static_cast<double>(p.utime), p.pose});
  return out;
}

std::optional<TruthComparison> compare(const std::vector<PathPose>& path,
                                       const std::vector<PathPose>& truth) {
  TruthComparison c;
  c.pairs = pair_with_truth(in_seconds(path), in_seconds(truth));
  if (c.pairs.empty()) return std::nullopt;
  c.first = absolute_error(c.pairs, align_first(c.pairs));
  c.best = absolute_error(c.pairs, align_least_squares(c.pairs));
  return c;
}

void check_all_loops(const RunRecord& run, Results& out) {
  std::vector<GraphEdge> edges;
  for (const auto& [id, edge] : run.graph.edges()) edges.push_back(edge);
  out.loops_in_map = check_loops(edges, out.nodes);
  if (run.truth.empty()) return;
  Path nodes;
  for (const auto& [id, utime] : run.graph.node_utimes()) nodes.push_back({1e-6 * static_cast<double>(utime), Pose2()});
  const std::vector<PosePair> pairs = pair_with_truth(nodes, in_seconds(run.truth));
  std::map<NodeId, Pose2> T_world_node;
  auto pair = pairs.begin();
  for (const auto& [id, utime] : run.graph.node_utimes())
    if (pair != pairs.end() && pair->stamp_s == 1e-6 * static_cast<double>(utime)) T_world_node[id] = (pair++)->T_world_base;
  out.loops_in_truth = check_loops(edges, T_world_node);
}

}  // namespace

Results work_out(const RunRecord& run) {
  Results out;
  measure_time(run, out);
  assemble_path(run, out);
  assemble_map(run, out);
  check_all_loops(run, out);
  out.graph_g2o = g2o_text(out.nodes, run.graph.edges(), &out.edges_without_node);
  out.error = compare(out.path, run.truth);
  out.odometry_error = compare(run.odometry, run.truth);
  for (const auto& [name, path] : run.peers)
    if (auto error = compare(path, run.truth)) out.peer_errors.emplace_back(name, std::move(*error));
  return out;
}

}  // namespace modslam::report
