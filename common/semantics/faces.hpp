// SPDX-License-Identifier: BSD-3-Clause
/// @file Planar subdivision by GEOS: lines in, bounded faces out; unions and hulls of faces. The
/// room outlines are made of these.
#pragma once
#include <memory>
#include <vector>

#include "common/semantics/types.hpp"

namespace modslam {

/// A polygon with holes; all rings are not repeated at their end.
struct Face {
  Polygon outline;
  std::vector<Polygon> holes;
  double area_m2 = 0;
};

/// The bounded faces of the arrangement of the lines (thesis 3.4.2: all loops of the wall graph,
/// crossings split).
std::vector<Face> bounded_faces(const std::vector<Segment>& lines);

/// Union of faces; gaps up to 2 * glue_m are closed. Largest piece only; outlines are simplified to
/// `simplify_m`.
/// @return area 0 when there is nothing.
Face united(const std::vector<Face>& faces, double glue_m, double simplify_m);

/// Area of the convex hull of both.
double hull_area_m2(const Face& p, const Face& q);

/// Every line lengthened at both ends up to the first other line it meets, at most by `reach_m`.
std::vector<Segment> lengthened(const std::vector<Segment>& lines, double reach_m);

/// Every line lengthened at both ends by `reach_m`, whatever it meets.
std::vector<Segment> lengthened_through(const std::vector<Segment>& lines, double reach_m);

}  // namespace modslam
