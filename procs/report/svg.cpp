// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/svg.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace modslam::report {
namespace {

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double t =
      d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

bool is_inside(const Eigen::Vector2d& p, const Points& polygon) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      inside = !inside;
  }
  return inside;
}

std::string shape(const char* tag, const Points& points, const std::string& attributes) {
  std::string out = std::string("<") + tag + " " + attributes + " points=\"";
  for (const Eigen::Vector2d& p : points) out += number(p.x()) + "," + number(p.y()) + " ";
  if (!points.empty()) out.pop_back();
  return out + "\"/>\n";
}

std::string pair(const char* x, const char* y, const Eigen::Vector2d& p) {
  return std::string(" ") + x + "=\"" + number(p.x()) + "\" " + y + "=\"" + number(p.y()) + "\"";
}

}  // namespace

std::string fixed(double value, int decimals) {
  char digits[400];
  std::snprintf(digits, sizeof digits, "%.*f", decimals, std::isfinite(value) ? value : 0.0);
  return digits;
}

std::string number(double value, int decimals) {
  std::string text = fixed(value, decimals);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t')
      out += c;
  }
  return out;
}

std::string base64(std::string_view bytes) {
  static const char* const alphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < have ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= have ? alphabet[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

Points simplify(const Points& points, double tolerance) {
  if (points.size() < 3) return points;
  std::vector<char> keep(points.size(), 0);
  keep.front() = keep.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    std::size_t farthest = a;
    double most = tolerance;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double d = distance_to_segment(points[i], points[a], points[b]);
      if (d > most) most = d, farthest = i;
    }
    if (farthest == a) continue;
    keep[farthest] = 1;
    open.push_back({a, farthest});
    open.push_back({farthest, b});
  }
  Points kept;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (keep[i]) kept.push_back(points[i]);
  return kept;
}

std::string polyline(const Points& points, const std::string& attributes) {
  return shape("polyline", points, attributes);
}

std::string polygon(const Points& points, const std::string& attributes) {
  return shape("polygon", points, attributes);
}

std::string line(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                 const std::string& attributes) {
  return "<line " + attributes + pair("x1", "y1", a) + pair("x2", "y2", b) + "/>\n";
}

std::string circle(const Eigen::Vector2d& centre, double radius, const std::string& attributes) {
  return "<circle " + attributes + pair("cx", "cy", centre) + " r=\"" + number(radius) + "\"/>\n";
}

std::string text_at(const Eigen::Vector2d& place, std::string_view words,
                    const std::string& attributes) {
  return "<text " + attributes + pair("x", "y", place) + ">" + escape(words) + "</text>\n";
}

double round_step(double span, int pieces) {
  if (!(span > 0) || !std::isfinite(span)) return 1;
  const double least = span / pieces, ten = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * ten >= least * (1 - 1e-9)) return factor * ten;
  return 10 * ten;
}

Eigen::Vector2d label_point(const Points& polygon) {
  if (polygon.empty()) return Eigen::Vector2d::Zero();
  Eigen::Vector2d low = polygon[0], high = polygon[0];
  for (const Eigen::Vector2d& p : polygon) low = low.cwiseMin(p), high = high.cwiseMax(p);
  Eigen::Vector2d best = (low + high) / 2;
  double most = -1;
  constexpr int kGrid = 32;
  for (int i = 1; i < kGrid; ++i)
    for (int j = 1; j < kGrid; ++j) {
      const Eigen::Vector2d p = low + (high - low).cwiseProduct(Eigen::Vector2d(i, j)) / kGrid;
      if (!is_inside(p, polygon)) continue;
      double room = 1e300;
      for (std::size_t k = 0; k < polygon.size(); ++k)
        room =
            std::min(room, distance_to_segment(p, polygon[k], polygon[(k + 1) % polygon.size()]));
      // Words are wide: of places with about the same room the middle one reads best.
      room -= 0.02 * (p - (low + high) / 2).norm();
      if (room > most) most = room, best = p;
    }
  return best;
}

}  // namespace modslam::report
