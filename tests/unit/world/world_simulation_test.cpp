// SPDX-License-Identifier: BSD-3-Clause
#include "common/world/world_simulation.hpp"

#include <catch2/catch.hpp>

#include "common/world/drive_limits.hpp"
#include "common/world/step_period.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/small_worlds.hpp"

namespace modslam {
namespace {

struct Drive {
  explicit Drive(const std::string& route)
      : world(square_room()), simulation(world, route_of(world, route), false) {
    while (!simulation.state().finished && simulation.state().step < 20000) simulation.advance();
  }
  World world;
  WorldSimulation simulation;
};

TEST_CASE("the robot starts on the route's first point, looking at the second") {
  const World world = square_room();
  const WorldSimulation simulation(world, route_of(world, "sides"), false);
  CHECK_THAT(simulation.state().T_world_base, IsNear(Pose2(-1, -1, 0), 1e-12, 1e-12));
  CHECK(simulation.state().step == 0);
  CHECK(simulation.utime() == WorldSimulation::kStart_utime);
}

TEST_CASE("a smooth route ends at its last point without touching anything") {
  const Drive run("sides");
  CHECK(run.simulation.state().finished);
  CHECK(run.simulation.touching_steps() == 0);
  CHECK_THAT(run.simulation.state().T_world_base, IsNear(Pose2(-1, 0.5, kPi), 0.03, 0.05));
  CHECK(run.simulation.path_m() == Approx(5.5).margin(0.4));
}

TEST_CASE("a route with turns in place drives its whole length") {
  const Drive run("corners");
  CHECK(run.simulation.state().finished);
  CHECK_THAT(run.simulation.state().T_world_base, IsNear(Pose2(-1, 0.5, kPi), 0.03, 0.05));
  CHECK(run.simulation.path_m() == Approx(5.5).margin(0.05));
}

TEST_CASE("a smooth route drives a dead end to its tip before it turns back") {
  World world = square_room();
  world.routes = {{"dead end", {{-1, -1}, {1, -1}, {-1, -0.9}}, 0.5, 0.5, false}};
  WorldSimulation simulation(world, world.routes[0], false);
  double farthest_m = -1;
  while (!simulation.state().finished && simulation.state().step < 20000) {
    simulation.advance();
    farthest_m = std::max(farthest_m, simulation.state().T_world_base.x);
  }
  CHECK(farthest_m == Approx(1.0).margin(0.03));
  CHECK_THAT(simulation.state().T_world_base, IsNear(Pose2(-1, -0.9, kPi), 0.03, 0.1));
}

TEST_CASE("wheels agree with the motion, and keep within the drive's limits") {
  const World world = square_room();
  WorldSimulation simulation(world, route_of(world, "sides"), false);
  Pose2 last = simulation.state().T_world_base;
  double last_speed = 0, turned_rad = 0;
  while (!simulation.state().finished) {
    simulation.advance();
    const SimulationState& state = simulation.state();
    REQUIRE(state.speed_mps <= 0.5 + 1e-9);
    REQUIRE(std::abs(state.yaw_rate) <= kMaxYawRate + 1e-9);
    REQUIRE(std::abs(state.speed_mps - last_speed) <= kMaxAcceleration * 0.01 + 1e-9);
    turned_rad += wrap_angle(state.T_world_base.heading - last.heading);
    last = state.T_world_base;
    last_speed = state.speed_mps;
  }
  CHECK(simulation.state().wheel_turn_rad == Approx(turned_rad).margin(1e-9));
  CHECK(simulation.state().wheel_distance_m == Approx(simulation.path_m()));
}

TEST_CASE("at a wall the robot stops, its wheels roll on, and it gives up in the end") {
  const Drive run("into the wall");
  CHECK(run.simulation.state().finished);
  CHECK(run.simulation.stuck());
  CHECK(run.simulation.touching_steps() > 1000);
  CHECK(run.simulation.state().T_world_base.x == Approx(2 - kRobotRadius_m).margin(0.01));
  CHECK(run.simulation.state().wheel_distance_m > run.simulation.path_m() + 1);
}

TEST_CASE("a route that starts on an obstacle is refused by name") {
  const World world = square_room();
  CHECK_THROWS_WITH(WorldSimulation(world, route_of(world, "from the wall"), false),
                    Catch::Contains("from the wall") && Catch::Contains("square room"));
}

TEST_CASE("a sensor speaks once a period, also when steps are lost or begin anew") {
  StepPeriod period(20, 100);
  std::vector<std::int64_t> due;
  for (const std::int64_t step : {0, 1, 4, 5, 6, 12, 13, 15, 15, 3, 4, 5})
    if (period.due(step)) due.push_back(step);
  CHECK(due == std::vector<std::int64_t>{0, 5, 12, 15, 3, 5});
}

}  // namespace
}  // namespace modslam
