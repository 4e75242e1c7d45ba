// SPDX-License-Identifier: BSD-3-Clause
/// @file Steers a differential drive along a route.
///
/// A route is cut into legs where the robot has to turn on the spot: at every corner of a route
/// with turn_in_place, else only where it all but reverses. A leg is entered by turning towards it
/// and driven by pure pursuit: aim at the point `look-ahead` farther along the leg, on the arc of
/// curvature 2 sin(alpha) / distance (Coulter, CMU-RI-TR-92-01).
#pragma once
#include <Eigen/Core>
#include <vector>

#include "common/geometry/pose2.hpp"
#include "common/world/world.hpp"

namespace modslam {

/// Forward speed [m/s] and turn rate [rad/s], counter-clockwise.
struct Twist {
  double speed_mps = 0, yaw_rate = 0;
};

class RouteFollower {
 public:
  explicit RouteFollower(const Route& route);

  /// Where the route starts, looking along its first leg.
  Pose2 T_world_start() const;

  /// What to drive now. `moving` is what the robot does now: it stops before it turns on the spot.
  Twist command(const Pose2& T_world_base, const Twist& moving);

  bool finished() const { return leg_ == legs_.size(); }

 private:
  using Leg = std::vector<Eigen::Vector2d>;

  void advance_along_leg(const Eigen::Vector2d& place);
  Eigen::Vector2d point_at(double way_m) const;
  double leg_length_m() const;
  Twist turn_towards_leg(const Pose2& T_world_base, const Twist& moving);
  Twist pursue(const Pose2& T_world_base) const;

  double cruise_mps_, look_ahead_m_;
  std::vector<Leg> legs_;
  std::size_t leg_ = 0;
  bool turning_ = true;
  double way_m_ = 0;  ///< along the leg, never back: a route may cross itself
};

}  // namespace modslam
