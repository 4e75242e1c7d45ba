// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/semantic_files.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

namespace modslam {
namespace {

using Json = nlohmann::ordered_json;
using Ring = std::vector<Eigen::Vector2d>;

/// Tenths of a millimetre are enough; non-finite numbers have no place in JSON.
double rounded(double value) { return std::isfinite(value) ? std::round(value * 1e4) / 1e4 : 0.0; }

Json point(const Eigen::Vector2d& p) { return Json::array({rounded(p.x()), rounded(p.y())}); }

Json line(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return {{"type", "LineString"}, {"coordinates", {point(a), point(b)}}}; }

/// A closed ring, as GeoJSON wants it.
Json polygon(const Ring& outline) {
  Json ring = Json::array();
  for (const Eigen::Vector2d& p : outline) ring.push_back(point(p));
  if (!ring.empty()) ring.push_back(Json(ring[0]));
  return {{"type", "Polygon"}, {"coordinates", Json::array({ring})}};
}

Json feature(const Json& properties, const Json& geometry) {
  return {{"type", "Feature"}, {"properties", properties}, {"geometry", geometry}};
}

Json wall_end(const WallEnd& end) { return {{"across_m", rounded(end.across_m)}, {"along_m", rounded(end.along_m)}, {"seen", end.seen}}; }

std::string corners(const Ring& outline) {
  std::ostringstream out;
  for (const Eigen::Vector2d& p : outline) out << rounded(p.x()) << ',' << rounded(p.y()) << ' ';
  return out.str();
}

std::string stroke(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const char* style) {
  std::ostringstream out;
  out << "<line x1='" << rounded(a.x()) << "' y1='" << rounded(a.y()) << "' x2='" << rounded(b.x()) << "' y2='" << rounded(b.y()) << "' " << style
      << "/>\n";
  return out.str();
}

}  // namespace

std::string semantic_geojson(const SemanticLayers& layers) {
  Json features = Json::array();
  for (const Wall& w : layers.walls)
    features.push_back(feature({{"kind", "wall"},
                                {"id", w.id},
                                {"length_m", rounded(w.length_m())},
                                {"evidence", rounded(w.evidence)},
                                {"sigma_m", rounded(w.sigma_m)},
                                {"ends", {wall_end(w.at_a), wall_end(w.at_b)}}},
                               line(w.a, w.b)));
  for (const Room& r : layers.rooms)
    features.push_back(feature({{"kind", "room"},
                                {"id", r.id},
                                {"type", r.corridor ? "corridor" : "room"},
                                {"area_m2", rounded(r.area_m2)},
                                {"explored", rounded(r.explored)},
                                {"name", r.name}},
                               polygon(r.outline)));
  for (const Door& d : layers.doors)
    features.push_back(feature({{"kind", "door"},
                                {"id", d.id},
                                {"width_m", rounded(d.width_m())},
                                {"rooms", {d.room_a, d.room_b}},
                                {"state", d.closed ? "closed" : "open"},
                                {"evidence", rounded(d.evidence)}},
                               line(d.a, d.b)));
  for (const Object& o : layers.objects)
    features.push_back(
        feature({{"kind", "object"}, {"id", o.id}, {"class", o.class_name}, {"class_confidence", rounded(o.class_confidence)}, {"area_m2", rounded(o.area_m2)}},
                polygon(o.outline)));
  for (const Place& p : layers.places)
    features.push_back(feature({{"kind", "place"}, {"id", p.node}, {"class", place_name(p.kind)}, {"confidence", rounded(p.confidence)}},
                               {{"type", "Point"}, {"coordinates", point(p.p)}}));
  // A name may hold bytes that are no UTF-8: replaced, not fatal.
  return Json({{"type", "FeatureCollection"}, {"features", features}}).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string semantic_svg(const SemanticLayers& layers) {
  Eigen::Vector2d low(0, 0), high(1, 1);
  bool first = true;
  const auto take = [&](const Eigen::Vector2d& p) {
    if (!p.allFinite()) return;
    low = first ? p : Eigen::Vector2d(low.cwiseMin(p));
    high = first ? p : Eigen::Vector2d(high.cwiseMax(p));
    first = false;
  };
  for (const Wall& w : layers.walls) take(w.a), take(w.b);
  for (const Room& r : layers.rooms)
    for (const Eigen::Vector2d& p : r.outline) take(p);
  constexpr double kMargin_m = 0.5, kPixels = 40;
  low.array() -= kMargin_m;
  high.array() += kMargin_m;
  std::ostringstream out;
  out << "<svg xmlns='http://www.w3.org/2000/svg' width='" << std::lround(kPixels * (high.x() - low.x())) << "' height='"
      << std::lround(kPixels * (high.y() - low.y())) << "' viewBox='" << rounded(low.x()) << ' ' << rounded(-high.y()) << ' '
      << rounded(high.x() - low.x()) << ' ' << rounded(high.y() - low.y()) << "'>\n<rect x='" << rounded(low.x()) << "' y='" << rounded(-high.y())
      << "' width='100%' height='100%' fill='#fff'/>\n<g transform='scale(1,-1)' stroke-linecap='round'>\n";
  for (const Room& r : layers.rooms)
    out << "<polygon points='" << corners(r.outline) << "' fill='" << (r.corridor ? "#e8eef7" : "#f7f0dc") << "' stroke='#b8a878' stroke-width='0.03'/>\n";
  for (const Object& o : layers.objects) out << "<polygon points='" << corners(o.outline) << "' fill='#c8d8c8' stroke='#608060' stroke-width='0.03'/>\n";
  for (const Wall& w : layers.walls) out << stroke(w.a, w.b, "stroke='#a02020' stroke-width='0.06'");
  for (const Door& d : layers.doors) out << stroke(d.a, d.b, d.closed ? "stroke='#806000' stroke-width='0.1'" : "stroke='#f0a000' stroke-width='0.1'");
  out << "</g>\n</svg>\n";
  return out.str();
}

}  // namespace modslam
