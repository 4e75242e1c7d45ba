// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "common/semantics/types.hpp"

namespace modslam {

/// A GeoJSON FeatureCollection in map metres (x right, y up). properties.kind: wall (LineString;
/// id, length_m, evidence), room (Polygon; id, type, area_m2, explored, name), door (LineString
/// jamb to jamb; id, width_m, rooms [a, b] with null where none is known, state), object (Polygon;
/// id, class, area_m2). Ids are strings: "wall3", "room1".
std::string semantic_geojson(const Semantics& semantics);

}  // namespace modslam
