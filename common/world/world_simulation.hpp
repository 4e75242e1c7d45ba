// SPDX-License-Identifier: BSD-3-Clause
/// @file A robot that drives a route through a world, in steps of 10 ms.
#pragma once
#include <cstdint>
#include <string>

#include "common/config/visitor.hpp"
#include "common/world/obstacles.hpp"
#include "common/world/route_follower.hpp"

namespace modslam {

struct SimulatorConfig {
  static constexpr const char* kTable = "simulator";
  std::string world = "config/worlds/apartment.geojson";
  std::string route = "demo";
  std::int64_t laps = 1;
  std::int64_t seed = 1;
  bool people = false;
  double speed = 1;
  double delay_s = 2;

  void visit(ConfigVisitor& v) {
    v.text("world", world, "World file (GeoJSON).");
    v.text("route", route, "Id of the route that is driven.");
    v.integer("laps", laps, 1, 10'000, "", "How often it is driven: there, back, there again.");
    v.integer("seed", seed, 0, 1'000'000'000, "",
              "Start of every random stream: another seed, other noise.");
    v.flag("people", people,
           "Everybody in the world walks; false: only those whom the file enables.");
    v.number("speed", speed, 0.05, 50, "", "Simulated seconds per second of a live run.");
    v.number("delay_s", delay_s, 0, 60, "s",
             "A live run starts that late, so that all processes listen.");
  }
};

/// The true state, all since the start. Wheels roll on when the robot is stuck at a wall.
struct SimulationState {
  std::int64_t step = 0;
  Pose2 T_world_base;
  double wheel_distance_m = 0, wheel_turn_rad = 0;
  double speed_mps = 0, yaw_rate = 0;  ///< true ones
  bool touches = false;                ///< an obstacle stopped the robot in this step
  bool finished = false;               ///< the route has ended, or the robot is stuck for good
};

class WorldSimulation {
 public:
  static constexpr std::int64_t kStep_us = 10'000;
  static constexpr double kSteps_per_s = 100;
  static constexpr std::int64_t kStart_utime = 1'000'000;  ///< never 0: that means "no time yet"

  /// @throws std::invalid_argument when the route starts on an obstacle.
  WorldSimulation(const World& world, const Route& route, bool everybody_walks);

  /// Ten milliseconds more. After the end of the route the state stays.
  void advance();

  const SimulationState& state() const { return state_; }
  std::int64_t utime() const { return utime_of(state_.step); }
  std::int64_t touching_steps() const { return touching_steps_; }
  bool stuck() const { return stuck_steps_ >= kPatience_steps; }
  double path_m() const { return path_m_; }  ///< driven in truth

  static std::int64_t utime_of(std::int64_t step) { return kStart_utime + step * kStep_us; }
  static double time_s(std::int64_t step) { return 1e-6 * static_cast<double>(step * kStep_us); }

 private:
  static constexpr std::int64_t kPatience_steps = 2000;  // 20 s at one wall

  void roll(const Twist& wheels);

  Obstacles obstacles_;
  RouteFollower follower_;
  Twist wheels_;
  SimulationState state_;
  std::int64_t touching_steps_ = 0, stuck_steps_ = 0;
  double path_m_ = 0;
};

}  // namespace modslam
