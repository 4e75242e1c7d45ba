// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/plots.hpp"

#include <algorithm>
#include <cmath>
#include <modslam/scan_match_t.hpp>

#include "procs/report/svg.hpp"

namespace modslam::report {
namespace {

constexpr double kWidth = 1080, kLeft = 74, kRight = 12;

/// Time since the first scan along x.
struct TimeAxis {
  std::int64_t start_utime;
  double duration_s;

  double seconds(std::int64_t utime) const {
    return seconds_between(start_utime, utime);
  }
  double px(double t_s) const {
    return kLeft +
           (kWidth - kLeft - kRight) * std::clamp(t_s / std::max(duration_s, 1e-9), 0.0, 1.0);
  }
};

std::string time_ticks(const TimeAxis& axis, double top, double bottom) {
  std::string out;
  const double step = round_step(axis.duration_s, 12);
  for (double t = 0; t <= axis.duration_s; t += step) {
    out += line({axis.px(t), top}, {axis.px(t), bottom}, "class=\"lattice\"");
    out += text_at({axis.px(t), bottom + 15}, number(t, 3) + " s",
                   "class=\"tick\" text-anchor=\"middle\"");
  }
  return out;
}

struct Series {
  std::string style;
  const std::vector<PosePair>* pairs;
  const std::vector<double>* errors;  ///< of either sign
  std::int64_t start_utime;
};

/// Errors span decades: the axis is logarithmic, between whole decades.
struct DecadeAxis {
  double low, high, top, bottom;  // powers of ten; pixels
  double px(double value) const {
    const double share = (std::log10(std::max(value, 1e-12)) - low) / (high - low);
    return bottom - (bottom - top) * std::clamp(share, 0.0, 1.0);
  }
};

DecadeAxis decades_of(const std::vector<Series>& series, double top, double bottom) {
  double most = 0;
  std::vector<double> all;
  for (const Series& s : series)
    for (const double e : *s.errors) {
      most = std::max(most, std::abs(e));
      if (e != 0) all.push_back(std::abs(e));
    }
  if (all.empty()) return {-3, 0, top, bottom};
  const auto few = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 50);
  std::nth_element(all.begin(), few, all.end());
  const double high = std::ceil(std::log10(most) - 1e-9);
  return {std::clamp(std::floor(std::log10(*few)), high - 5, high - 1), high, top, bottom};
}

/// The worst error in each pixel column.
Points worst_by_column(const Series& s, const TimeAxis& time, const DecadeAxis& value) {
  std::map<int, double> worst;
  for (std::size_t i = 0; i < s.pairs->size(); ++i) {
    const TimeAxis own{s.start_utime, time.duration_s};
    const int column = static_cast<int>(own.px(own.seconds(std::llround(1e6 * (*s.pairs)[i].stamp_s))));
    double& e = worst[column];
    e = std::max(e, std::abs((*s.errors)[i]));
  }
  Points points;
  for (const auto& [column, e] : worst)
    points.push_back({static_cast<double>(column), value.px(e)});
  return points;
}

std::string error_plot(const char* title, const char* unit, const TimeAxis& time,
                       const std::vector<Series>& series) {
  constexpr double top = 26, bottom = 210;
  const DecadeAxis value = decades_of(series, top, bottom);
  std::string out = "<svg class=\"plot\" viewBox=\"0 0 1080 232\" role=\"img\" aria-label=\"" +
                    escape(title) + "\">\n";
  out += text_at({kLeft, 15}, title, "class=\"plot-title\"") + time_ticks(time, top, bottom);
  for (double d = value.low; d <= value.high; ++d) {
    const double y = value.px(std::pow(10.0, d));
    out += line({kLeft, y}, {kWidth - kRight, y}, "class=\"lattice\"");
    out += text_at({kLeft - 6, y + 4}, number(std::pow(10.0, d), 6) + " " + unit,
                   "class=\"tick\" text-anchor=\"end\"");
  }
  for (const Series& s : series)
    out += polyline(simplify(worst_by_column(s, time, value), 0.3),
                    "class=\"curve " + s.style + "\"");
  return out + "</svg>\n";
}

/// How much a verdict deserves to be seen when several fall on one pixel.
int severity(int verdict) {
  switch (verdict) {
    case scan_match_t::OK:
      return 1;
    case scan_match_t::FIRST:
      return 2;
    case scan_match_t::DEGENERATE:
      return 3;
    case scan_match_t::AMBIGUOUS:
      return 4;
    case scan_match_t::LOW_OVERLAP:
      return 5;
    case scan_match_t::INCONSISTENT:
      return 6;
    case scan_match_t::FAILED:
      return 7;
    default:
      return 8;
  }
}

std::string rect(double x, double y, double width, double height, int verdict) {
  return "<rect class=\"v" + std::to_string(verdict) + "\" x=\"" + number(x) + "\" y=\"" +
         number(y) + "\" width=\"" + number(width) + "\" height=\"" + number(height) + "\"/>\n";
}

int known(int verdict) { return verdict >= 0 && verdict < kVerdicts ? verdict : 0; }

/// Neighbouring columns of one verdict become one rectangle.
std::string strip(const std::vector<Judged>& judged, const TimeAxis& time, double y,
                  double height) {
  std::map<int, int> worst;
  for (const Judged& j : judged) {
    const int column = static_cast<int>(time.px(time.seconds(j.utime)));
    const auto [at, fresh] = worst.try_emplace(column, known(j.verdict));
    if (!fresh && severity(known(j.verdict)) > severity(at->second)) at->second = known(j.verdict);
  }
  std::string out;
  for (auto at = worst.begin(); at != worst.end();) {
    const int begin = at->first, verdict = at->second;
    int end = begin + 1;
    // A slow laser leaves columns without a scan: they belong to the scan before them.
    for (++at; at != worst.end() && at->second == verdict && at->first - end < 30; ++at)
      end = at->first + 1;
    if (at != worst.end() && at->first - end < 30) end = at->first;
    out += rect(begin, y, std::max(end - begin, 2), height, verdict);  // one bad scan must be seen
  }
  return out;
}

std::string legend(const RunRecord& run) {
  std::int64_t count[kVerdicts] = {};
  for (const Judged& j : run.match_verdicts.empty() ? run.pose_verdicts : run.match_verdicts)
    ++count[known(j.verdict)];
  std::string out = "<div class=\"legend\">";
  for (int v = 0; v < kVerdicts; ++v)
    if (count[v])
      out += "<span><i class=\"swatch v" + std::to_string(v) + "\"></i>" + verdict_name(v) +
             " <b>" + std::to_string(count[v]) + "</b></span>";
  return out + "</div>\n";
}

}  // namespace

std::string error_plots(const Results& r) {
  if (!r.error) return "";
  const TimeAxis time{r.start_utime, r.duration_s};
  std::vector<Series> position, heading;
  if (r.odometry_error) {
    position.push_back(
        {"odometry", &r.odometry_error->pairs, &r.odometry_error->first.positions_m, r.start_utime});
    heading.push_back(
        {"odometry", &r.odometry_error->pairs, &r.odometry_error->first.headings_deg, r.start_utime});
  }
  // Colours of their own, beside those of the comparison of runs.
  std::string peers;
  for (std::size_t i = 0; i < r.peer_errors.size(); ++i) {
    const auto& [name, error] = r.peer_errors[i];
    const std::string style = "run" + std::to_string(1 + i % 5);
    position.push_back({style, &error.pairs, &error.first.positions_m, r.start_utime});
    heading.push_back({style, &error.pairs, &error.first.headings_deg, r.start_utime});
    peers += "<span><i class=\"swatch " + style + "\"></i>" + escape(name) + "</span>";
  }
  position.push_back({"ours", &r.error->pairs, &r.error->first.positions_m, r.start_utime});
  heading.push_back({"ours", &r.error->pairs, &r.error->first.headings_deg, r.start_utime});
  std::string keys = "<div class=\"legend\"><span><i class=\"swatch path\"></i>ModSLAM</span>";
  if (r.odometry_error) keys += "<span><i class=\"swatch odometry\"></i>odometry alone</span>";
  return keys + peers + "</div>\n" +
         error_plot("position error, aligned at the first pose", "m", time, position) +
         error_plot("heading error", "°", time, heading);
}

std::string compared_error_plots(const std::vector<NamedResults>& runs) {
  constexpr int kColours = 6;
  TimeAxis time{0, 0};
  std::vector<Series> position, heading;
  std::string keys = "<div class=\"legend\">";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Results& r = *runs[i].results;
    const std::string style = "run" + std::to_string(i % kColours);
    time.duration_s = std::max(time.duration_s, r.duration_s);
    position.push_back({style, &r.error->pairs, &r.error->first.positions_m, r.start_utime});
    heading.push_back({style, &r.error->pairs, &r.error->first.headings_deg, r.start_utime});
    keys += "<span><i class=\"swatch " + style + "\"></i>" + escape(runs[i].name) + "</span>";
  }
  return keys + "</div>\n" +
         error_plot("position error, aligned at the first pose", "m", time, position) +
         error_plot("heading error", "°", time, heading);
}

std::string verdict_timeline(const RunRecord& run, const Results& r) {
  if (run.match_verdicts.empty() && run.pose_verdicts.empty()) return "";
  const TimeAxis time{r.start_utime, r.duration_s};
  std::string out = legend(run) +
                    "<svg class=\"plot\" viewBox=\"0 0 1080 118\" role=\"img\" "
                    "aria-label=\"verdicts over time\">\n" +
                    time_ticks(time, 6, 96);
  const auto name = [](double y, const char* words) {
    return text_at({kLeft - 6, y}, words, "class=\"tick\" text-anchor=\"end\"");
  };
  out += name(22, "matcher") + strip(run.match_verdicts, time, 8, 20);
  out += name(52, "estimator") + strip(run.pose_verdicts, time, 38, 20);
  out += name(84, "loops");
  for (const LoopProposal& p : run.proposals) {
    const bool meant = p.verdict == scan_match_t::OK || p.verdict == scan_match_t::DEGENERATE;
    const double x = time.px(time.seconds(p.utime));
    out += line({x, meant ? 68.0 : 80.0}, {x, 90},
                "class=\"mark s" + std::to_string(known(p.verdict)) + "\"");
  }
  return out + "</svg>\n";
}

}  // namespace modslam::report
