// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/summary.hpp"

#include <cmath>
#include <cstdio>

#include "common/bus/channels.hpp"

namespace modslam::report {
namespace {

double rounded(double value) { return std::isfinite(value) ? std::round(value * 1e6) / 1e6 : 0.0; }

Json figures_json(const Statistics& f) {
  return {{"mean", rounded(f.mean)}, {"rms", rounded(f.rms)}, {"max", rounded(f.max)}};
}

Json comparison_json(const TruthComparison& c) {
  const auto one = [](const AbsoluteError& e) -> Json {
    return {{"position_m", figures_json(e.position_m)},
            {"heading_deg", figures_json(e.heading_deg)}};
  };
  return {{"poses_compared", c.pairs.size()},
          {"aligned_at_first_pose", one(c.first)},
          {"aligned_by_least_squares", one(c.best)}};
}

/// STATUS is left out: it is sent by the clock.
Json loop_check_json(const LoopCheck& check) {
  return {{"chi2", rounded(check.worst_chi2)}, {"where_known_m", rounded(check.worst_m)}, {"from", check.from}, {"to", check.to}};
}

Json channels_json(const RunRecord& run) {
  Json channels = Json::object();
  for (const auto& [name, tally] : run.channels) {
    if (name == channel::kStatus) continue;
    channels[name] = {{"messages", tally.messages}};
    if (tally.undecodable) channels[name]["undecodable"] = tally.undecodable;
  }
  return channels;
}

template <class Items>
Json verdicts_json(const Items& items) {
  std::int64_t count[kVerdicts] = {};
  for (const auto& item : items)
    ++count[item.verdict >= 0 && item.verdict < kVerdicts ? item.verdict : 0];
  Json json = Json::object();
  for (int v = 0; v < kVerdicts; ++v)
    if (count[v]) json[verdict_name(v)] = count[v];
  return json;
}

Json processes_json(const RunRecord& run) {
  Json processes = Json::object();
  for (const auto& [name, status] : run.last_status) {
    std::int64_t bad = 0, gaps = 0;
    for (const channel_count_t& input : status.inputs) bad += input.bad, gaps += input.gaps;
    processes[name] = {{"bad", bad}, {"gaps", gaps}};
  }
  return processes;
}

Json semantics_json(const SemanticRecord& s) {
  double wall_length_m = 0, room_area_m2 = 0;
  for (const wall_t& w : s.walls.items())
    wall_length_m += std::hypot(w.b[0] - w.a[0], w.b[1] - w.a[1]);
  for (const room_t& r : s.rooms.items()) room_area_m2 += r.area_m2;
  return {{"walls", s.walls.items().size()}, {"wall_length_m", rounded(wall_length_m)},
          {"rooms", s.rooms.items().size()}, {"room_area_m2", rounded(room_area_m2)},
          {"doors", s.doors.items().size()}, {"objects", s.objects.items().size()}};
}

std::string text(const char* format, double a, double b = 0, double c = 0) {
  char line[160];
  std::snprintf(line, sizeof line, format, a, b, c);
  return line;
}

std::string count(const Json& n, const char* word = "") {
  return std::to_string(n.get<std::int64_t>()) + (*word ? " " : "") + word;
}

std::string error_line(const Json& error) {
  const Json& first = error.at("aligned_at_first_pose");
  const Json& best = error.at("aligned_by_least_squares");
  const auto three = [](const Json& f, const char* format) {
    return text(format, f.at("mean").get<double>(), f.at("rms").get<double>(),
                f.at("max").get<double>());
  };
  return three(first.at("position_m"), "mean %.3f  rms %.3f  max %.3f m") +
         three(first.at("heading_deg"), "   heading mean %.2f  rms %.2f  max %.2f deg\n") +
         "                " +
         three(best.at("position_m"),
               "mean %.3f  rms %.3f  max %.3f m   when laid over the truth by least squares\n");
}

}  // namespace

Json summarise(const RunRecord& run, const Results& r) {
  Json s;
  s["modslam"] = MODSLAM_VERSION;
  if (run.sim)
    s["simulation"] = {{"world", run.sim->world},
                       {"route", run.sim->route},
                       {"noise", run.sim->noise},
                       {"seed", run.sim->seed},
                       {"world_sha256", run.sim->world_sha256}};
  s["log_damage"] = run.damage;
  s["scans"] = run.laser_utimes.size();
  s["duration_s"] = rounded(r.duration_s);
  s["stamps_stepped_back"] = r.stamps_stepped_back;
  s["path_length_m"] = rounded(r.path_length_m);
  s["poses"] = r.path.size();
  s["scans_without_pose"] = r.scans_without_pose;
  s["poses_without_scan"] = r.poses_without_scan;
  s["graph"] = {{"nodes", r.nodes.size()},
                {"edges", run.graph.edges().size()},
                {"loop_edges", r.loops_in_map.loops},
                {"edges_without_node", r.edges_without_node},
                {"epoch", run.graph.epoch()},
                {"nodes_missing_in_log", run.graph.missing_nodes()},
                {"updates_missing_in_log", run.graph.missing_updates()}};
  s["loops"] = {{"proposed", run.proposals.size()},
                {"accepted", run.graph.loops_accepted()},
                {"retracted", run.graph.loops_retracted()},
                {"verdicts", verdicts_json(run.proposals)},
                {"worst_in_map", loop_check_json(r.loops_in_map)}};
  if (r.loops_in_truth) s["loops"]["worst_in_truth"] = loop_check_json(*r.loops_in_truth);
  s["verdicts"] = {{"scan_match", verdicts_json(run.match_verdicts)},
                   {"pose", verdicts_json(run.pose_verdicts)}};
  s["map"] = {{"tiles", run.tiles.size()},
              {"width_cells", r.map.width},
              {"height_cells", r.map.height},
              {"resolution_m", rounded(r.map.resolution_m)},
              {"known_area_m2", rounded(r.known_area_m2)},
              {"trouble", r.map_trouble}};
  s["semantics"] = semantics_json(run.semantics);
  if (r.error) s["error"] = comparison_json(*r.error);
  if (r.odometry_error) s["odometry_error"] = comparison_json(*r.odometry_error);
  s["processes"] = processes_json(run);
  s["channels"] = channels_json(run);
  return s;
}

std::vector<std::vector<std::string>> score_rows(const Json& scores, double wall_tolerance_m) {
  const auto share = [](const Json& part, const char* key) {
    return text("%.1f %%", 100 * part.at(key).get<double>());
  };
  std::vector<std::vector<std::string>> rows;
  const Json& walls = scores.at("walls");
  for (const Json& at : walls.at("at")) {
    if (wall_tolerance_m > 0 && at.at("tolerance_m") != wall_tolerance_m) continue;
    rows.push_back({text("walls, within %.2f m", at.at("tolerance_m").get<double>()),
                    text("%.1f m", walls.at("found_m").get<double>()),
                    text("%.1f m", walls.at("visible_m").get<double>()), share(at, "precision"),
                    share(at, "recall")});
  }
  const auto things = [&](const char* name, const Json& part, const char* visible) {
    rows.push_back({name, count(part.at("found")), count(part.at(visible)),
                    share(part, "precision"), share(part, "recall")});
  };
  things("rooms, half overlap", scores.at("rooms"), "explored_truth");
  things("doors, within 0.5 m", scores.at("doors"), "visible_truth");
  return rows;
}

std::string terminal_table(const Json& s, const std::string& folder) {
  const Json& graph = s.at("graph");
  const Json& loops = s.at("loops");
  const Json& semantics = s.at("semantics");
  std::string out;
  out += "  drive         " + count(s.at("scans"), "scans") +
         text(" in %.1f s, path of %.1f m\n", s.at("duration_s").get<double>(),
              s.at("path_length_m").get<double>());
  if (s.contains("error")) out += "  path error    " + error_line(s.at("error"));
  if (s.contains("odometry_error")) out += "  odometry's    " + error_line(s.at("odometry_error"));
  if (!s.contains("error")) out += "  path error    unknown: the log holds no ground truth\n";
  out += "  graph         " + count(graph.at("nodes"), "nodes, ") +
         count(graph.at("edges"), "edges\n");
  out += "  loops         " + count(loops.at("proposed"), "proposed, ") +
         count(loops.at("accepted"), "accepted, ") + count(loops.at("retracted"), "retracted\n");
  out += "  found         " + count(semantics.at("walls"), "walls") +
         text(" (%.1f m), ", semantics.at("wall_length_m").get<double>()) +
         count(semantics.at("rooms"), "rooms") +
         text(" (%.1f m2), ", semantics.at("room_area_m2").get<double>()) +
         count(semantics.at("doors"), "doors, ") + count(semantics.at("objects"), "objects\n");
  if (s.contains("semantic_scores"))
    for (const auto& row : score_rows(s.at("semantic_scores"), 0.1)) {
      char line[200];
      std::snprintf(line, sizeof line,
                    "                %-20s %8s found of %8s visible, precision %s, recall %s\n",
                    row[0].c_str(), row[1].c_str(), row[2].c_str(), row[3].c_str(), row[4].c_str());
      out += line;
    }
  if (s.at("scans_without_pose").get<std::int64_t>() > 0)
    out += "  note          " +
           count(s.at("scans_without_pose"), "scans have no pose of their own: interpolated\n");
  if (!s.at("log_damage").get<std::string>().empty())
    out += "  DAMAGE        run.lcm: " + s.at("log_damage").get<std::string>() + "\n";
  out += "  results       " + folder +
         "/report.html, map.png, semantic.geojson, path.tum, graph.g2o, summary.json\n";
  return out;
}

}  // namespace modslam::report
