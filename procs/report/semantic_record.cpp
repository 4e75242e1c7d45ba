// SPDX-License-Identifier: BSD-3-Clause
#include "procs/report/semantic_record.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace modslam::report {
namespace {

using Json = nlohmann::ordered_json;

/// Tenths of a millimetre are enough; non-finite numbers have no place in JSON.
double rounded(double value) { return std::isfinite(value) ? std::round(value * 1e4) / 1e4 : 0.0; }

Json point(double x, double y) { return Json::array({rounded(x), rounded(y)}); }

template <class Item>
Json line(const Item& item) {
  return {{"type", "LineString"},
          {"coordinates", {point(item.a[0], item.a[1]), point(item.b[0], item.b[1])}}};
}

/// A closed ring, as GeoJSON wants it.
template <class Item>
Json polygon(const Item& item) {
  Json ring = Json::array();
  for (std::size_t i = 0; i < item.x.size(); ++i) ring.push_back(point(item.x[i], item.y[i]));
  if (!ring.empty()) ring.push_back(Json(ring[0]));
  return {{"type", "Polygon"}, {"coordinates", Json::array({ring})}};
}

Json feature(const Json& properties, const Json& geometry) {
  return {{"type", "Feature"}, {"properties", properties}, {"geometry", geometry}};
}

}  // namespace

const char* room_type_name(int type) {
  return type == room_t::ROOM ? "room" : type == room_t::CORRIDOR ? "corridor" : "unknown";
}

const char* door_state_name(int state) {
  return state == door_t::OPEN ? "open" : state == door_t::CLOSED ? "closed" : "unknown";
}

std::string semantic_geojson(const SemanticRecord& record) {
  Json features = Json::array();
  for (const wall_t& w : record.walls.items()) {
    const double length_m = std::hypot(w.b[0] - w.a[0], w.b[1] - w.a[1]);
    features.push_back(feature({{"kind", "wall"},
                                {"id", w.id},
                                {"length_m", rounded(length_m)},
                                {"evidence", rounded(w.evidence)},
                                {"sigma_m", rounded(w.sigma_m)}},
                               line(w)));
  }
  for (const room_t& r : record.rooms.items())
    features.push_back(feature({{"kind", "room"},
                                {"id", r.id},
                                {"type", room_type_name(r.type)},
                                {"area_m2", rounded(r.area_m2)},
                                {"explored", rounded(r.explored)},
                                {"name", r.name}},
                               polygon(r)));
  for (const door_t& d : record.doors.items())
    features.push_back(feature({{"kind", "door"},
                                {"id", d.id},
                                {"width_m", rounded(d.width_m)},
                                {"rooms", {d.room_a, d.room_b}},
                                {"state", door_state_name(d.state)},
                                {"evidence", rounded(d.evidence)}},
                               line(d)));
  for (const object_t& o : record.objects.items())
    features.push_back(feature({{"kind", "object"},
                                {"id", o.id},
                                {"class", o.class_name},
                                {"area_m2", rounded(o.area_m2)}},
                               polygon(o)));
  // A name may hold bytes that are no UTF-8: replaced, not fatal.
  return Json({{"type", "FeatureCollection"}, {"features", features}})
             .dump(1, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

}  // namespace modslam::report
