// SPDX-License-Identifier: BSD-3-Clause
/// @file What stands in the way in a world: rays end at it and robots bump into it.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "common/geometry/pose2.hpp"
#include "common/world/world.hpp"

class b2World;

namespace modslam {

/// Walls as boxes of their thickness, closed doors, objects (all edges in Box2D: exact, no raster)
/// and people as moving circles.
class Obstacles {
 public:
  /// `everybody_walks`: people of the world that are not enabled walk too.
  explicit Obstacles(const World& world, bool everybody_walks = false);
  ~Obstacles();
  Obstacles(const Obstacles&) = delete;
  Obstacles& operator=(const Obstacles&) = delete;

  /// Moves the people to where they are `time_s` after the start.
  void set_time(double time_s);

  /// Distance [m] from `origin` to what a ray of that bearing hits first; `max_m` when nothing is
  /// nearer. World frame; right to a millimetre.
  double cast(const Eigen::Vector2d& origin, double bearing_rad, double max_m) const;

  /// Whether a circle overlaps an obstacle's edge or a person.
  bool touches_circle(const Eigen::Vector2d& centre, double radius_m) const;

 private:
  void add_edges(const std::vector<Eigen::Vector2d>& outline);
  void add_wall(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double thickness_m);

  struct Walker {
    Person person;
    double length_m;
    Eigen::Vector2d place;
  };
  std::unique_ptr<b2World> edges_;
  std::vector<Walker> walkers_;
};

}  // namespace modslam
