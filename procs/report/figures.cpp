// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/figures.hpp"

#include <cstdio>
#include <regex>

#include "procs/report/map_view.hpp"
#include "procs/report/page.hpp"
#include "procs/report/plots.hpp"

namespace modslam::report {
namespace {

/// The page's style without its dark half, every variable replaced by its value: not every reader
/// of SVG knows variables.
std::string plain_style() {
  const std::string page = kPageStyle;
  const std::size_t rules = page.find("\n* {");
  const std::string variables = page.substr(0, page.find("@media screen"));
  std::string style = page.substr(rules, page.find("@media print") - rules);
  const std::regex definition("(--[a-z]+): ([^;]+);");
  for (std::sregex_iterator it(variables.begin(), variables.end(), definition), end; it != end;
       ++it) {
    const std::string use = "var(" + (*it)[1].str() + ")", value = (*it)[2].str();
    for (std::size_t at; (at = style.find(use)) != std::string::npos;)
      style.replace(at, use.size(), value);
  }
  return style +
         "text { font-family: 'DejaVu Sans', sans-serif; font-size: 13px; }\n.tick { font-size: "
         "11px; }\n";
}

}  // namespace

std::vector<std::string> pictures_in(const std::string& html) {
  static const std::string kEnd = "</svg>";
  std::vector<std::string> pictures;
  for (std::size_t begin = html.find("<svg"); begin != std::string::npos;
       begin = html.find("<svg", begin + 1)) {
    const std::size_t end = html.find(kEnd, begin);
    if (end == std::string::npos) break;
    pictures.push_back(html.substr(begin, end + kEnd.size() - begin));
  }
  return pictures;
}

std::string standalone(const std::string& svg) {
  static const std::string kStyle = plain_style();
  const std::size_t head_end = svg.find('>'), box = svg.find("viewBox=\"0 0 ");
  double width = 1000, height = 600;
  if (box < head_end) std::sscanf(svg.c_str() + box, "viewBox=\"0 0 %lf %lf", &width, &height);
  char head[200];
  std::snprintf(head, sizeof head,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\"", width,
                height);
  return head + svg.substr(4, head_end - 4) + ">\n<style>" + kStyle +
         "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" +
         svg.substr(head_end + 1) + "\n";
}

std::vector<std::pair<std::string, std::string>> figures_of(const RunRecord& run,
                                                            const Results& r) {
  std::vector<std::pair<std::string, std::string>> figures;
  const auto add = [&](const std::string& html, const std::vector<std::string>& names) {
    const std::vector<std::string> pictures = pictures_in(html);
    for (std::size_t i = 0; i < std::min(pictures.size(), names.size()); ++i)
      figures.emplace_back(names[i], standalone(pictures[i]));
  };
  add(map_view(run, r, nullptr), {"map"});
  add(error_plots(r), {"error_position", "error_heading"});
  add(verdict_timeline(run, r), {"verdicts"});
  return figures;
}

}  // namespace modslam::report
