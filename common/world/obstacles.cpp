// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/obstacles.hpp"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>

namespace modslam {
namespace {

constexpr double kDoorLeaf_m = 0.04;  // thickness of a closed door

b2Vec2 to_b2(const Eigen::Vector2d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y())};
}

struct NearestHit : b2RayCastCallback {
  float ReportFixture(b2Fixture*, const b2Vec2&, const b2Vec2&, float fraction) override {
    nearest = std::min(nearest, fraction);
    return nearest;  // Box2D cuts the ray here and looks on
  }
  float nearest = 1;
};

struct CircleOverlap : b2QueryCallback {
  CircleOverlap(const Eigen::Vector2d& centre, double radius_m) {
    circle.m_p = to_b2(centre);
    circle.m_radius = static_cast<float>(radius_m);
    at_origin.SetIdentity();
  }
  bool ReportFixture(b2Fixture* fixture) override {
    overlaps = b2TestOverlap(fixture->GetShape(), 0, &circle, 0, at_origin, at_origin);
    return !overlaps;  // false ends the query
  }
  b2CircleShape circle;
  b2Transform at_origin;
  bool overlaps = false;
};

double length_of(const std::vector<Eigen::Vector2d>& points) {
  double length_m = 0;
  for (std::size_t k = 1; k < points.size(); ++k) length_m += (points[k] - points[k - 1]).norm();
  return length_m;
}

Eigen::Vector2d point_along(const std::vector<Eigen::Vector2d>& points, double way_m) {
  for (std::size_t k = 1; k < points.size(); ++k) {
    const double piece_m = (points[k] - points[k - 1]).norm();
    if (way_m <= piece_m && piece_m > 0)
      return points[k - 1] + way_m / piece_m * (points[k] - points[k - 1]);
    way_m -= piece_m;
  }
  return points.back();
}

/// Where a ray meets a circle first, or `max_m`; 0 from inside.
double cast_at_circle(const Eigen::Vector2d& to_centre, const Eigen::Vector2d& direction,
                      double radius_m, double max_m) {
  const double outside = to_centre.squaredNorm() - radius_m * radius_m;
  if (outside <= 0) return 0;
  const double along_m = to_centre.dot(direction);
  const double discriminant = along_m * along_m - outside;
  if (along_m <= 0 || discriminant < 0) return max_m;
  return std::min(max_m, along_m - std::sqrt(discriminant));
}

}  // namespace

Obstacles::Obstacles(const World& world, bool everybody_walks)
    : edges_(std::make_unique<b2World>(b2Vec2(0, 0))) {
  for (const WorldWall& wall : world.walls) add_wall(wall.a, wall.b, wall.thickness_m);
  for (const WorldDoor& door : world.doors)
    if (!door.open) add_wall(door.a, door.b, kDoorLeaf_m);
  for (const WorldObject& object : world.objects) add_edges(object.polygon);
  for (const Person& person : world.persons)
    if ((person.enabled || everybody_walks) && !person.points.empty())
      walkers_.push_back({person, length_of(person.points), person.points.front()});
}

Obstacles::~Obstacles() = default;

void Obstacles::add_edges(const std::vector<Eigen::Vector2d>& outline) {
  b2BodyDef at_origin;
  b2Body* body = edges_->CreateBody(&at_origin);
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d &a = outline[k], &b = outline[(k + 1) % outline.size()];
    if (a == b) continue;
    b2EdgeShape edge;
    edge.SetTwoSided(to_b2(a), to_b2(b));
    edge.m_radius = 0;  // no skin: contact is where the laser sees the edge
    body->CreateFixture(&edge, 0);
  }
}

void Obstacles::add_wall(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double thickness_m) {
  const Eigen::Vector2d along = (b - a).normalized();
  const Eigen::Vector2d aside = thickness_m / 2 * Eigen::Vector2d(-along.y(), along.x());
  add_edges({a - aside, b - aside, b + aside, a + aside});
}

void Obstacles::set_time(double time_s) {
  for (Walker& walker : walkers_) {
    if (walker.length_m <= 0) continue;
    const double way_m = std::fmod(walker.person.speed_mps * time_s, 2 * walker.length_m);
    walker.place = point_along(walker.person.points, std::min(way_m, 2 * walker.length_m - way_m));
  }
}

double Obstacles::cast(const Eigen::Vector2d& origin, double bearing_rad, double max_m) const {
  const Eigen::Vector2d direction(std::cos(bearing_rad), std::sin(bearing_rad));
  NearestHit hit;
  edges_->RayCast(&hit, to_b2(origin), to_b2(origin + max_m * direction));
  double range_m = hit.nearest < 1 ? static_cast<double>(hit.nearest) * max_m : max_m;
  for (const Walker& walker : walkers_)
    range_m = cast_at_circle(walker.place - origin, direction, walker.person.radius_m, range_m);
  return range_m;
}

bool Obstacles::touches_circle(const Eigen::Vector2d& centre, double radius_m) const {
  for (const Walker& walker : walkers_)
    if ((walker.place - centre).norm() < walker.person.radius_m + radius_m) return true;
  CircleOverlap query(centre, radius_m);
  b2AABB box;
  query.circle.ComputeAABB(&box, query.at_origin, 0);
  edges_->QueryAABB(&query, box);
  return query.overlaps;
}

}  // namespace modslam
