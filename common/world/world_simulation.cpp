// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/world_simulation.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/world/drive_limits.hpp"
#include "common/world/wheel_motion.hpp"

namespace modslam {
namespace {

constexpr double kStep_s = 1e-6 * static_cast<double>(WorldSimulation::kStep_us);

/// `from` moved towards `wanted` as fast as the acceleration allows.
double approach(double from, double wanted, double acceleration) {
  return from + std::clamp(wanted - from, -acceleration * kStep_s, acceleration * kStep_s);
}

}  // namespace

WorldSimulation::WorldSimulation(const World& world, const Route& route, bool everybody_walks)
    : obstacles_(world, everybody_walks), follower_(route) {
  state_.T_world_base = follower_.T_world_start();
  obstacles_.set_time(0);
  if (obstacles_.touches_circle(state_.T_world_base.translation(), kRobotRadius_m))
    throw std::invalid_argument(world.name + ": route '" + route.id + "' starts on an obstacle");
}

void WorldSimulation::advance() {
  if (state_.finished) return;
  ++state_.step;
  obstacles_.set_time(time_s(state_.step));
  const Twist wanted = follower_.command(state_.T_world_base, wheels_);
  wheels_.speed_mps = approach(wheels_.speed_mps, wanted.speed_mps, kMaxAcceleration);
  wheels_.yaw_rate = approach(wheels_.yaw_rate, wanted.yaw_rate, kMaxYawAcceleration);
  roll(wheels_);
  const bool stands = wheels_.speed_mps == 0 && wheels_.yaw_rate == 0;
  state_.finished = (follower_.finished() && stands) || stuck();
}

void WorldSimulation::roll(const Twist& wheels) {
  const double distance_m = wheels.speed_mps * kStep_s, turn_rad = wheels.yaw_rate * kStep_s;
  state_.wheel_distance_m += distance_m;
  state_.wheel_turn_rad += turn_rad;
  Pose2 moved = state_.T_world_base * arc_motion(distance_m, turn_rad);
  state_.touches = obstacles_.touches_circle(moved.translation(), kRobotRadius_m);
  if (state_.touches) {  // the wheels slip; a round robot can still turn
    moved.x = state_.T_world_base.x;
    moved.y = state_.T_world_base.y;
    ++touching_steps_;
  }
  stuck_steps_ = state_.touches ? stuck_steps_ + 1 : 0;
  path_m_ += state_.touches ? 0 : std::abs(distance_m);
  state_.speed_mps = state_.touches ? 0 : wheels.speed_mps;
  state_.yaw_rate = wheels.yaw_rate;
  state_.T_world_base = moved;
}

}  // namespace modslam
