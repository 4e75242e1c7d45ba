// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/page.hpp"

#include <cmath>

#include "procs/report/plots.hpp"

namespace modslam::report {
namespace {

std::string section(const std::string& title, const std::string& body) {
  return body.empty() ? "" : "<section>\n<h2>" + escape(title) + "</h2>\n" + body + "</section>\n";
}

/// A table whose cells are plain text; columns named with a leading '#' hold numbers.
class Table {
 public:
  explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}
  void row(const std::vector<std::string>& cells) {
    rows_ += "<tr>";
    for (std::size_t i = 0; i < cells.size(); ++i) rows_ += cell("td", i, cells[i]);
    rows_ += "</tr>\n";
    ++count_;
  }
  std::string html() const {
    if (!count_) return "";
    std::string head;
    for (std::size_t i = 0; i < columns_.size(); ++i)
      head += cell("th", i, is_number(i) ? columns_[i].substr(1) : columns_[i]);
    return "<table><tr>" + head + "</tr>\n" + rows_ + "</table>\n";
  }
  /// Long tables are folded away.
  std::string folded(const std::string& title) const {
    if (!count_) return "";
    return "<details" + std::string(count_ <= 12 ? " open" : "") + "><summary>" + escape(title) +
           " (" + std::to_string(count_) + ")</summary>" + html() + "</details>\n";
  }

 private:
  bool is_number(std::size_t i) const { return columns_[i][0] == '#'; }
  std::string cell(const char* tag, std::size_t i, const std::string& words) const {
    return std::string("<") + tag + (is_number(i) ? " class=\"n\">" : ">") + escape(words) + "</" +
           tag + ">";
  }
  std::vector<std::string> columns_;
  std::string rows_;
  int count_ = 0;
};

std::string fact(const std::string& figure, const std::string& words) {
  return "<div class=\"fact\"><b>" + escape(figure) + "</b><span>" + escape(words) +
         "</span></div>\n";
}

std::string clock_time(double seconds) {
  const long whole = std::lround(seconds);
  return whole < 120 ? number(seconds) + " s"
                     : std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
}

std::string centimetres(double metres) { return fixed(metres * 100, metres < 0.1 ? 1 : 0) + " cm"; }

std::string header(const RunRecord& run, const Results& r) {
  std::string words = "ModSLAM " MODSLAM_VERSION;
  if (run.sim)
    words += " · simulated world " + run.sim->world + ", route " + run.sim->route + ", noise " +
             run.sim->noise + ", seed " + std::to_string(run.sim->seed);
  const std::size_t loops = run.graph.loops_accepted();
  const SemanticRecord& s = run.semantics;
  std::string facts;
  if (r.error) {
    const Statistics& e = r.error->first.position_m;
    facts += fact(centimetres(e.mean), "mean path error, at most " + centimetres(e.max));
  }
  facts += fact(number(r.path_length_m) + " m", "path, driven in " + clock_time(r.duration_s));
  facts += fact(std::to_string(run.laser_utimes.size()),
                "scans, " + std::to_string(r.nodes.size()) + " of them nodes of the graph");
  facts += fact(std::to_string(loops),
                "loops closed of " + std::to_string(run.proposals.size()) + " looked at, " +
                    std::to_string(run.graph.loops_retracted()) + " taken back");
  facts += fact(number(r.known_area_m2, 0) + " m²",
                "known, in cells of " + number(r.map.resolution_m * 100) + " cm");
  facts +=
      fact(std::to_string(s.rooms.items().size()) + " / " + std::to_string(s.doors.items().size()),
           "rooms / doors, " + std::to_string(s.walls.items().size()) + " walls, " +
               std::to_string(s.objects.items().size()) + " objects");
  return "<header><h1 id=\"run\">Run</h1><p>" + escape(words) +
         "</p></header>\n<div class=\"facts\">\n" + facts + "</div>\n";
}

/// What a reader must know before believing the rest.
std::string warnings(const RunRecord& run, const Results& r) {
  std::string list;
  const auto say = [&](const std::string& words) { list += "<li>" + escape(words) + "</li>\n"; };
  if (!run.damage.empty())
    say("The log is damaged: " + run.damage + ". All that could be read is in this report.");
  if (!r.map_trouble.empty()) say("There is no map: " + r.map_trouble + ".");
  if (r.scans_without_pose > 0)
    say(std::to_string(r.scans_without_pose) +
        " scans have no pose of their own; the laser's path is interpolated there.");
  if (run.graph.missing_nodes() > 0)
    say(std::to_string(run.graph.missing_nodes()) + " nodes are missing in the log.");
  if (run.graph.missing_updates() > 0)
    say(std::to_string(run.graph.missing_updates()) + " graph updates are missing in the log.");
  for (const auto& [name, tally] : run.channels)
    if (tally.undecodable)
      say(std::to_string(tally.undecodable) + " messages on " + name + " cannot be decoded.");
  return list.empty()
             ? ""
             : "<section class=\"warning\"><h2>Mind this</h2><ul>" + list + "</ul></section>\n";
}

std::string error_table(const Results& r) {
  if (!r.error) return "<p class=\"note\">The log holds no ground truth.</p>\n";
  Table table({"path", "laid over the truth by", "#mean", "#rms", "#max", "#heading mean",
               "#heading rms", "#heading max"});
  const auto add = [&](const std::string& name, const char* how, const AbsoluteError& e) {
    const Statistics &p = e.position_m, &h = e.heading_deg;
    const auto metres = [](double v) { return fixed(v, 3) + " m"; };
    const auto degrees = [](double v) { return fixed(v, 2) + "°"; };
    table.row({name, how, metres(p.mean), metres(p.rms), metres(p.max), degrees(h.mean),
               degrees(h.rms), degrees(h.max)});
  };
  add("ModSLAM", "its first pose", r.error->first);
  add("ModSLAM", "least squares", r.error->best);
  if (r.odometry_error) {
    add("odometry alone", "its first pose", r.odometry_error->first);
    add("odometry alone", "least squares", r.odometry_error->best);
  }
  for (const auto& [name, error] : r.peer_errors) {
    add(escape(name), "its first pose", error.first);
    add(escape(name), "least squares", error.best);
  }
  return table.html();
}

std::string room_names(const SemanticRecord& s, std::int64_t a, std::int64_t b) {
  const auto name = [&](std::int64_t id) -> std::string {
    for (const room_t& room : s.rooms.items())
      if (room.id == id)
        return room.name.empty() ? room_type_name(room.type) + (" " + std::to_string(id))
                                 : room.name;
    return id ? "room " + std::to_string(id) : "?";
  };
  return name(a) + " – " + name(b);
}

std::string semantic_tables(const SemanticRecord& s) {
  Table rooms({"id", "name", "type", "#area", "#explored"});
  for (const room_t& r : s.rooms.items())
    rooms.row({std::to_string(r.id), r.name, room_type_name(r.type), fixed(r.area_m2, 1) + " m²",
               fixed(100 * r.explored, 0) + " %"});
  Table doors({"id", "between", "state", "#width", "#evidence"});
  for (const door_t& d : s.doors.items())
    doors.row({std::to_string(d.id), room_names(s, d.room_a, d.room_b), door_state_name(d.state),
               fixed(d.width_m, 2) + " m", fixed(d.evidence, 1)});
  Table walls({"id", "#length", "#x, y of one end", "#and of the other", "#sigma", "#evidence"});
  for (const wall_t& w : s.walls.items()) {
    const auto place = [](const double(&p)[2]) { return fixed(p[0], 2) + ", " + fixed(p[1], 2); };
    walls.row({std::to_string(w.id), fixed(std::hypot(w.b[0] - w.a[0], w.b[1] - w.a[1]), 2) + " m",
               place(w.a), place(w.b), fixed(w.sigma_m * 1000, 0) + " mm", fixed(w.evidence, 1)});
  }
  Table objects({"id", "class", "#area", "#evidence"});
  for (const object_t& o : s.objects.items())
    objects.row(
        {std::to_string(o.id), o.class_name, fixed(o.area_m2, 2) + " m²", fixed(o.evidence, 1)});
  const std::string two = rooms.folded("Rooms") + doors.folded("Doors");
  return two + walls.folded("Walls") + objects.folded("Objects");
}

/// Against the true world, when that was given.
std::string score_table(const Json& summary) {
  if (!summary.contains("semantic_scores")) return "";
  Table table({"against the true world", "#found", "#visible in the run", "#precision", "#recall"});
  for (const auto& row : score_rows(summary.at("semantic_scores"))) table.row(row);
  return table.html();
}

std::string state_name(int state) {
  static const char* const names[] = {"invalid", "running", "troubled", "finished", "stopped"};
  return names[state >= 0 && state < 5 ? state : 0];
}

std::string traffic_tables(const RunRecord& run, const Json& summary) {
  Table processes({"process", "state", "#messages in", "#refused", "#known missing"});
  for (const auto& [name, status] : run.last_status) {
    std::int64_t received = 0, bad = 0, gaps = 0;
    for (const channel_count_t& c : status.inputs)
      received += c.received, bad += c.bad, gaps += c.gaps;
    processes.row({name, state_name(status.state), std::to_string(received), std::to_string(bad),
                   std::to_string(gaps)});
  }
  Table channels({"channel", "#messages in the log"});
  for (const auto& [name, tally] : summary.at("channels").items())
    channels.row({name, std::to_string(tally.at("messages").get<std::int64_t>())});
  return "<div class=\"columns\"><div>" + processes.html() + "</div><div>" + channels.html() +
         "</div></div>\n";
}

/// Processes of one run mostly share their configuration: each text is shown once.
std::string parameters(const RunRecord& run) {
  std::map<std::string, std::string> who;
  for (const auto& [name, toml] : run.parameters)
    who[toml] += (who[toml].empty() ? "" : ", ") + name;
  std::string out;
  for (const auto& [toml, names] : who)
    out += "<details><summary>" + escape(names) + "</summary><pre>" + escape(toml) +
           "</pre></details>\n";
  return out;
}

}  // namespace

std::string report_page(const RunRecord& run, const Results& r, const Json& summary,
                        const WorldOutline* world) {
  const std::string errors = error_plots(r);
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>ModSLAM "
         "run</title>\n<style>" +
         std::string(kPageStyle) + "</style></head>\n<body><main>\n" + header(run, r) +
         warnings(run, r) + section("Map", map_view(run, r, world)) +
         section("Path error", errors + error_table(r)) +
         section("Verdicts over time", verdict_timeline(run, r)) +
         section("What was found", score_table(summary) + semantic_tables(run.semantics)) +
         section("Messages", traffic_tables(run, summary)) +
         section("Parameters in force", parameters(run)) +
         section("Timing",
                 "<div id=\"timing\"><p class=\"note\">There is no timing.js beside this "
                 "page.</p></div>\n") +
         "</main>\n<script>" + kPageScript +
         "</script>\n<script src=\"timing.js\"></script>\n</body></html>\n";
}

}  // namespace modslam::report
