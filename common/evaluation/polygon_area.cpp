// SPDX-License-Identifier: BSD-3-Clause
/// @file Areas of polygons by GEOS, whose C handles end with this file.
#include <geos_c.h>

#include <memory>

#include "common/evaluation/semantic_map.hpp"

namespace modslam {
namespace {

class Geos {
 public:
  Geos() : context_(GEOS_init_r()) {}
  ~Geos() { GEOS_finish_r(context_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  using Geometry = std::shared_ptr<GEOSGeometry>;

  Geometry polygon(const MapPolygon& from) const {
    std::vector<GEOSGeometry*> holes;
    for (const auto& hole : from.holes) holes.push_back(ring(hole));
    const Geometry raw = own(GEOSGeom_createPolygon_r(context_, ring(from.outline), holes.data(),
                                                      static_cast<unsigned>(holes.size())));
    return GEOSisValid_r(context_, raw.get()) == 1 ? raw
                                                   : own(GEOSMakeValid_r(context_, raw.get()));
  }
  Geometry intersection(const Geometry& p, const Geometry& q) const {
    return own(GEOSIntersection_r(context_, p.get(), q.get()));
  }
  double area(const Geometry& geometry) const {
    double area_m2 = 0;
    return geometry && GEOSArea_r(context_, geometry.get(), &area_m2) == 1 ? area_m2 : 0.0;
  }

 private:
  Geometry own(GEOSGeometry* geometry) const {
    return {geometry, [context = context_](GEOSGeometry* g) {
              if (g) GEOSGeom_destroy_r(context, g);
            }};
  }
  GEOSGeometry* ring(const std::vector<Eigen::Vector2d>& points) const {
    const auto n = static_cast<unsigned>(points.size());
    GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(context_, n + 1, 2);
    for (unsigned i = 0; i <= n; ++i)
      GEOSCoordSeq_setXY_r(context_, sequence, i, points[i % n].x(), points[i % n].y());
    return GEOSGeom_createLinearRing_r(context_, sequence);
  }

  GEOSContextHandle_t context_;
};

}  // namespace

double area_m2(const MapPolygon& polygon) {
  const Geos geos;
  return geos.area(geos.polygon(polygon));
}

double overlap_m2(const MapPolygon& p, const MapPolygon& q) {
  const Geos geos;
  const auto a = geos.polygon(p), b = geos.polygon(q);
  return a && b ? geos.area(geos.intersection(a, b)) : 0.0;
}

}  // namespace modslam
