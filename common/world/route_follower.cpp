// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/route_follower.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/world/drive_limits.hpp"

namespace modslam {
namespace {

constexpr double kShortestLookAhead_m = 0.25;
constexpr double kReversal_rad = 1.9;  // sharper corners than this are turned on the spot
constexpr double kAligned_rad = 0.01;  // a turn on the spot is done
constexpr double kArrived_m = 0.01;
constexpr double kCreep_mps = 0.03;  // slowest approach to the end of a leg
constexpr double kTurnGain_per_s = 2.5;

double direction_rad(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

}  // namespace

RouteFollower::RouteFollower(const Route& route)
    : cruise_mps_(route.speed_mps),
      look_ahead_m_(std::max(kShortestLookAhead_m, route.corner_radius_m)) {
  const auto& points = route.points;
  if (points.size() < 2)
    throw std::invalid_argument("route '" + route.id + "': fewer than 2 points");
  legs_.push_back({points[0]});
  for (std::size_t k = 1; k < points.size(); ++k) {
    legs_.back().push_back(points[k]);
    if (k + 1 == points.size()) break;
    const double corner_rad = wrap_angle(direction_rad(points[k], points[k + 1]) -
                                         direction_rad(points[k - 1], points[k]));
    if (route.turn_in_place || std::abs(corner_rad) > kReversal_rad) legs_.push_back({points[k]});
  }
}

Pose2 RouteFollower::T_world_start() const {
  const Leg& leg = legs_.front();
  return {leg[0].x(), leg[0].y(), direction_rad(leg[0], leg[1])};
}

Twist RouteFollower::command(const Pose2& T_world_base, const Twist& moving) {
  if (finished()) return {};
  if (turning_) {
    const Twist turn = turn_towards_leg(T_world_base, moving);
    if (turning_) return turn;
  }
  advance_along_leg(T_world_base.translation());
  if (leg_length_m() - way_m_ > kArrived_m) return pursue(T_world_base);
  ++leg_;
  turning_ = true;
  way_m_ = 0;
  return {};
}

Twist RouteFollower::turn_towards_leg(const Pose2& T_world_base, const Twist& moving) {
  if (std::abs(moving.speed_mps) > 1e-9) return {};
  // Aim at the look-ahead point, not along the leg: that takes out what the last leg left aside.
  const double off_rad = wrap_angle(
      direction_rad(T_world_base.translation(), point_at(look_ahead_m_)) - T_world_base.heading);
  turning_ = std::abs(off_rad) > kAligned_rad;
  return {0, std::clamp(kTurnGain_per_s * off_rad, -kMaxYawRate, kMaxYawRate)};
}

Twist RouteFollower::pursue(const Pose2& T_world_base) const {
  const Eigen::Vector2d aim = T_world_base.inverse() * point_at(way_m_ + look_ahead_m_);
  const double curvature = 2 * aim.y() / std::max(aim.squaredNorm(), 1e-6);
  const double left_m = leg_length_m() - way_m_;
  const double brake_mps = std::sqrt(2 * 0.8 * kMaxAcceleration * left_m);
  double speed_mps = std::min(cruise_mps_, std::max(kCreep_mps, brake_mps));
  if (std::abs(curvature) * speed_mps > kMaxYawRate) speed_mps = kMaxYawRate / std::abs(curvature);
  return {speed_mps, speed_mps * curvature};
}

double RouteFollower::leg_length_m() const {
  const Leg& leg = legs_[leg_];
  double length_m = 0;
  for (std::size_t k = 1; k < leg.size(); ++k) length_m += (leg[k] - leg[k - 1]).norm();
  return length_m;
}

/// The point of the leg that far from its start; beyond the end, straight on.
Eigen::Vector2d RouteFollower::point_at(double way_m) const {
  const Leg& leg = legs_[leg_];
  for (std::size_t k = 1;; ++k) {
    const Eigen::Vector2d piece = leg[k] - leg[k - 1];
    const double piece_m = piece.norm();
    if (way_m <= piece_m || k + 1 == leg.size()) return leg[k - 1] + way_m / piece_m * piece;
    way_m -= piece_m;
  }
}

/// Moves way_m_ to the nearest point of the leg within the look-ahead, beside or ahead of it.
void RouteFollower::advance_along_leg(const Eigen::Vector2d& place) {
  const Leg& leg = legs_[leg_];
  const double from_m = way_m_, to_m = way_m_ + look_ahead_m_;
  double nearest = (place - point_at(std::min(way_m_, leg_length_m()))).norm(), piece_start_m = 0;
  for (std::size_t k = 1; k < leg.size(); ++k) {
    const Eigen::Vector2d piece = leg[k] - leg[k - 1];
    const double piece_m = piece.norm();
    const double low = std::max(from_m - piece_start_m, 0.0),
                 high = std::min(to_m - piece_start_m, piece_m);
    if (low <= high) {
      const double along_m = std::clamp((place - leg[k - 1]).dot(piece) / piece_m, low, high);
      const double off_m = (place - leg[k - 1] - along_m / piece_m * piece).norm();
      if (off_m < nearest) nearest = off_m, way_m_ = piece_start_m + along_m;
    }
    piece_start_m += piece_m;
  }
}

}  // namespace modslam
