// SPDX-License-Identifier: BSD-3-Clause
#include "common/semantics/faces.hpp"

#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace modslam {
namespace {

/// GEOS keeps its errors to itself: what fails yields no geometry.
class Geos {
 public:
  Geos() : handle_(GEOS_init_r()) {}
  ~Geos() { GEOS_finish_r(handle_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;
  operator GEOSContextHandle_t() const { return handle_; }

 private:
  GEOSContextHandle_t handle_;
};

struct Destroy {
  GEOSContextHandle_t handle;
  void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(handle, geometry); }
};
using Geometry = std::unique_ptr<GEOSGeometry, Destroy>;

class Workshop {
 public:
  Geometry own(GEOSGeometry* geometry) const { return {geometry, Destroy{geos_}}; }

  GEOSCoordSequence* sequence(const Polygon& points, bool closed) const {
    const auto n = static_cast<unsigned>(points.size() + (closed ? 1 : 0));
    GEOSCoordSequence* s = GEOSCoordSeq_create_r(geos_, n, 2);
    for (unsigned i = 0; i < n; ++i) {
      const Eigen::Vector2d& p = points[i % points.size()];
      GEOSCoordSeq_setXY_r(geos_, s, i, p.x(), p.y());
    }
    return s;
  }
  GEOSGeometry* line(const Segment& s) const {
    return GEOSGeom_createLineString_r(geos_, sequence({s.a, s.b}, false));
  }
  GEOSGeometry* ring(const Polygon& points) const {
    return GEOSGeom_createLinearRing_r(geos_, sequence(points, true));
  }
  GEOSGeometry* polygon(const Face& face) const {
    std::vector<GEOSGeometry*> holes;
    for (const Polygon& hole : face.holes) holes.push_back(ring(hole));
    return GEOSGeom_createPolygon_r(geos_, ring(face.outline), holes.data(),
                                    static_cast<unsigned>(holes.size()));
  }
  Geometry collection(int type, std::vector<GEOSGeometry*> parts) const {
    return own(GEOSGeom_createCollection_r(geos_, type, parts.data(),
                                           static_cast<unsigned>(parts.size())));
  }

  Polygon points(const GEOSGeometry* ring) const {
    const GEOSCoordSequence* s = GEOSGeom_getCoordSeq_r(geos_, ring);
    unsigned n = 0;
    GEOSCoordSeq_getSize_r(geos_, s, &n);
    Polygon out;
    for (unsigned i = 0; i + 1 < n; ++i) {
      double x = 0, y = 0;
      GEOSCoordSeq_getXY_r(geos_, s, i, &x, &y);
      out.emplace_back(x, y);
    }
    if (signed_area_m2(out) < 0) std::reverse(out.begin(), out.end());
    return out;
  }
  Face face(const GEOSGeometry* polygon) const {
    Face out;
    out.outline = points(GEOSGetExteriorRing_r(geos_, polygon));
    for (int i = 0; i < GEOSGetNumInteriorRings_r(geos_, polygon); ++i)
      out.holes.push_back(points(GEOSGetInteriorRingN_r(geos_, polygon, i)));
    GEOSArea_r(geos_, polygon, &out.area_m2);
    return out;
  }
  std::vector<Face> faces(const GEOSGeometry* geometry) const {
    std::vector<Face> out;
    if (!geometry) return out;
    for (int i = 0; i < GEOSGetNumGeometries_r(geos_, geometry); ++i) {
      const GEOSGeometry* part = GEOSGetGeometryN_r(geos_, geometry, i);
      if (GEOSGeomTypeId_r(geos_, part) == GEOS_POLYGON && !GEOSisEmpty_r(geos_, part))
        out.push_back(face(part));
    }
    return out;
  }
  Geometry buffer(const GEOSGeometry* g, double by_m) const {
    return own(GEOSBufferWithStyle_r(geos_, g, by_m, 4, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_MITRE, 2.0));
  }
  GEOSContextHandle_t geos() const { return geos_; }

 private:
  Geos geos_;
};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

std::vector<Face> bounded_faces(const std::vector<Segment>& lines) {
  const Workshop w;
  std::vector<GEOSGeometry*> parts;
  for (const Segment& s : lines)
    if (s.length_m() > 1e-6) parts.push_back(w.line(s));
  if (parts.empty()) return {};
  const Geometry all = w.collection(GEOS_MULTILINESTRING, parts);
  const Geometry noded = w.own(GEOSUnaryUnionPrec_r(w.geos(), all.get(), 0.005));
  if (!noded) return {};
  const GEOSGeometry* input[] = {noded.get()};
  const Geometry polygons = w.own(GEOSPolygonize_r(w.geos(), input, 1));
  return w.faces(polygons.get());
}

Face united(const std::vector<Face>& faces, double glue_m, double simplify_m) {
  const Workshop w;
  std::vector<GEOSGeometry*> parts;
  for (const Face& face : faces)
    if (face.outline.size() >= 3) parts.push_back(w.polygon(face));
  if (parts.empty()) return {};
  const Geometry all = w.collection(GEOS_GEOMETRYCOLLECTION, parts);
  Geometry joined = w.own(GEOSUnaryUnion_r(w.geos(), all.get()));
  if (joined && glue_m > 0) {
    const Geometry fat = w.buffer(joined.get(), glue_m);
    joined = fat ? w.buffer(fat.get(), -glue_m) : std::move(joined);
  }
  if (joined && simplify_m > 0)
    joined = w.own(GEOSTopologyPreserveSimplify_r(w.geos(), joined.get(), simplify_m));
  const std::vector<Face> pieces = w.faces(joined.get());
  const auto largest =
      std::max_element(pieces.begin(), pieces.end(),
                       [](const Face& p, const Face& q) { return p.area_m2 < q.area_m2; });
  return largest == pieces.end() ? Face() : *largest;
}

double hull_area_m2(const Face& p, const Face& q) {
  std::vector<cv::Point2f> points, hull;
  const Eigen::Vector2d origin = p.outline.front();
  for (const Face* face : {&p, &q})
    for (const Eigen::Vector2d& corner : face->outline)
      points.emplace_back(static_cast<float>(corner.x() - origin.x()),
                          static_cast<float>(corner.y() - origin.y()));
  cv::convexHull(points, hull);
  return cv::contourArea(hull);
}

std::vector<Segment> lengthened(const std::vector<Segment>& lines, double reach_m) {
  std::vector<Segment> out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Segment& s = lines[i];
    const Eigen::Vector2d d = s.direction();
    double after = reach_m, before = reach_m;
    for (std::size_t j = 0; j < lines.size(); ++j) {
      if (j == i) continue;
      const Eigen::Vector2d e = lines[j].b - lines[j].a;
      const double denominator = cross(d, e);
      if (std::abs(denominator) < 0.2 * e.norm()) continue;
      const double along = cross(lines[j].a - s.a, e) / denominator;  // from s.a on s
      const double where = cross(lines[j].a - s.a, d) / denominator;  // 0..1 on line j
      const double slack = 0.3 / e.norm();  // its end may be as unsure as ours
      if (where < -slack || where > 1 + slack) continue;
      if (along > s.length_m() - 0.1) after = std::min(after, std::max(0.0, along - s.length_m()));
      if (along < 0.1) before = std::min(before, std::max(0.0, -along));
    }
    constexpr double kPast_m = 0.03;  // so that what meets also crosses
    out.push_back({s.a - (before + kPast_m) * d, s.b + (after + kPast_m) * d});
  }
  return out;
}

std::vector<Segment> lengthened_through(const std::vector<Segment>& lines, double reach_m) {
  std::vector<Segment> out;
  for (const Segment& s : lines)
    out.push_back({s.a - reach_m * s.direction(), s.b + reach_m * s.direction()});
  return out;
}

}  // namespace modslam
