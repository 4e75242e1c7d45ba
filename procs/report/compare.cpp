// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/compare.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "procs/report/figures.hpp"
#include "procs/report/map_view.hpp"
#include "procs/report/page.hpp"
#include "procs/report/plots.hpp"
#include "procs/report/svg.hpp"

namespace modslam::report {
namespace {

struct ComparedRun {
  std::string name;
  RunRecord record;
  Results results;
  Json timing;  ///< of an offline run; null without
};

/// What offline leaves beside the log: modslam_timing({...});
Json read_timing(const std::string& folder) {
  std::ifstream in(folder + "/timing.js");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t begin = text.find('{'), end = text.rfind('}');
  if (begin == std::string::npos || end == std::string::npos) return nullptr;
  return Json::parse(text.substr(begin, end - begin + 1), nullptr, false);
}

ComparedRun read_compared(const std::string& folder) {
  const std::string name =
      std::filesystem::path(folder + "/.").lexically_normal().parent_path().filename();
  ComparedRun run{name, read_run(folder + "/run.lcm"), {}, read_timing(folder)};
  run.results = work_out(run.record);
  return run;
}

std::string row(const char* tag, const std::vector<std::string>& cells) {
  std::string out = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i)
    out +=
        std::string("<") + tag + (i ? " class=\"n\">" : ">") + escape(cells[i]) + "</" + tag + ">";
  return out + "</tr>\n";
}

std::string table(const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& rows) {
  std::string out = "<div style=\"overflow-x:auto\"><table>" + row("th", head);
  for (const auto& cells : rows) out += row("td", cells);
  return out + "</table></div>\n";
}

std::string section(const char* title, const std::string& body) {
  return body.empty() ? ""
                      : std::string("<section>\n<h2>") + title + "</h2>\n" + body + "</section>\n";
}

std::string figures(const std::vector<ComparedRun>& runs) {
  std::vector<std::vector<std::string>> rows;
  for (const ComparedRun& run : runs) {
    const Results& r = run.results;
    const auto metres = [&](double Statistics::*what) {
      return r.error ? fixed(r.error->first.position_m.*what, 3) + " m" : std::string("–");
    };
    rows.push_back({run.name, std::to_string(run.record.laser_utimes.size()),
                    number(r.path_length_m) + " m", std::to_string(r.nodes.size()),
                    std::to_string(run.record.graph.loops_accepted()), metres(&Statistics::mean),
                    metres(&Statistics::rms), metres(&Statistics::max),
                    std::to_string(run.record.semantics.rooms.items().size()),
                    std::to_string(run.record.semantics.doors.items().size())});
  }
  return table(
      {"run", "scans", "path", "nodes", "loops", "error, mean", "rms", "max", "rooms", "doors"},
      rows);
}

/// Time a scan in each process: as an offline run measured it, else the 99 percent that STATUS
/// tells.
std::string run_times(const std::vector<ComparedRun>& runs) {
  std::set<std::string> names;
  for (const ComparedRun& run : runs) {
    if (run.timing.is_object() && run.timing.contains("modules"))
      for (const auto& [name, cost] : run.timing["modules"].items()) names.insert(name);
    else
      for (const auto& [name, status] : run.record.last_status)
        if (status.latency_p99_us > 0) names.insert(name);
  }
  std::vector<std::string> head = {"run", "measured"};
  head.insert(head.end(), names.begin(), names.end());
  std::vector<std::vector<std::string>> rows;
  for (const ComparedRun& run : runs) {
    const bool offline = run.timing.is_object() && run.timing.contains("modules");
    std::vector<std::string> cells = {run.name,
                                      offline ? "ms a scan" : "ms, 99 % within"};
    for (const std::string& name : names) {
      const auto status = run.record.last_status.find(name);
      const bool there = offline ? run.timing["modules"].contains(name)
                                 : status != run.record.last_status.end();
      const double ms = !there    ? 0
                        : offline ? run.timing["modules"][name].value("ms_per_scan", 0.0)
                                  : static_cast<double>(status->second.latency_p99_us) / 1000;
      cells.push_back(there ? fixed(ms, 3) : "–");
    }
    rows.push_back(cells);
  }
  return names.empty() ? "" : table(head, rows);
}

/// table.key -> value of the configuration that a run's processes said.
std::map<std::string, std::string> parameters_of(const RunRecord& run) {
  std::map<std::string, std::string> values;
  for (const auto& [process, toml] : run.parameters) {
    std::istringstream lines(toml);
    std::string line, name;
    while (std::getline(lines, line)) {
      const std::size_t equals = line.find(" = ");
      if (!line.empty() && line[0] == '[')
        name = line.substr(1, line.find(']') - 1) + ".";
      else if (equals != std::string::npos && line[0] != '#')
        values[name + line.substr(0, equals)] = line.substr(equals + 3);
    }
  }
  return values;
}

std::string differing_parameters(const std::vector<ComparedRun>& runs) {
  std::vector<std::map<std::string, std::string>> all;
  std::set<std::string> keys;
  for (const ComparedRun& run : runs) {
    all.push_back(parameters_of(run.record));
    for (const auto& [key, value] : all.back()) keys.insert(key);
  }
  std::vector<std::string> head = {"parameter"};
  for (const ComparedRun& run : runs) head.push_back(run.name);
  std::vector<std::vector<std::string>> rows;
  for (const std::string& key : keys) {
    std::vector<std::string> cells = {key};
    for (const auto& values : all) cells.push_back(values.count(key) ? values.at(key) : "–");
    const bool own = key.rfind("recorder.", 0) == 0 || key.rfind("viewer.", 0) == 0 ||
                     key.rfind("player.", 0) == 0;  // of the launch, not of the method
    if (!own && std::set<std::string>(cells.begin() + 1, cells.end()).size() > 1)
      rows.push_back(cells);
  }
  return rows.empty() ? "<p class=\"note\">None: the runs were made with the same parameters.</p>\n"
                      : table(head, rows);
}

/// As a picture of its own: names inside it do not meet those of its neighbours.
std::string picture(const ComparedRun& run) {
  const std::vector<std::string> pictures = pictures_in(map_view(run.record, run.results, nullptr));
  return pictures.empty() ? ""
                          : "<img alt=\"map of " + escape(run.name) +
                                "\" style=\"width:100%\" src=\"data:image/svg+xml;base64," +
                                base64(standalone(pictures[0])) + "\">";
}

std::string errors(const std::vector<ComparedRun>& runs) {
  std::vector<NamedResults> named;
  for (const ComparedRun& run : runs)
    if (run.results.error) named.push_back({run.name, &run.results});
  return named.empty() ? "<p class=\"note\">No log holds ground truth.</p>\n"
                       : compared_error_plots(named);
}

}  // namespace

std::string comparison_page(const std::vector<std::string>& folders) {
  std::vector<ComparedRun> runs;
  for (const std::string& folder : folders) runs.push_back(read_compared(folder));
  std::string maps;
  for (const ComparedRun& run : runs)
    maps += "<div><h3>" + escape(run.name) + "</h3>" + picture(run) + "</div>\n";
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
         "name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\">\n<title>ModSLAM runs "
         "compared</title>\n<style>" +
         std::string(kPageStyle) + "</style></head>\n<body><main>\n<header><h1>" +
         std::to_string(runs.size()) + " runs</h1><p>ModSLAM " MODSLAM_VERSION "</p></header>\n" +
         section("Figures", figures(runs)) + section("Path error", errors(runs)) +
         section("Run time", run_times(runs)) +
         section("Parameters that differ", differing_parameters(runs)) +
         section("Maps", "<div class=\"columns\">" + maps + "</div>") + "</main></body></html>\n";
}

}  // namespace modslam::report
