// SPDX-License-Identifier: BSD-3-Clause
/// matcher-bench: is the scan matcher's own opinion of its answers right? Random furnished rooms and corridors, injected failures.
///
/// NEES: e' I e of a match against the truth, with the information that it reports; its mean is the number of observed directions when
/// the report is honest. A silent failure is an answer that may become an edge and is wrong by more than 0.10 m or 0.03 rad in a
/// direction that it claims to have observed.
#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/matching/scan_matcher.hpp"
#include "tests/support/synthetic_scan.hpp"

using namespace modslam;
using namespace modslam::test;

namespace {

constexpr double kWrong_m = 0.10, kWrong_rad = 0.03;

/// A room of random size with up to six pieces of furniture; the origin and 0.8 m around it stay free.
Plan random_room(RandomStream& random) {
  Plan plan;
  const double width_m = random.uniform(4.5, 9), depth_m = random.uniform(4.0, 7);
  add_box(plan, -width_m / 2, -depth_m / 2, width_m / 2, depth_m / 2);
  for (int wanted = 3 + static_cast<int>(random.uniform(0, 4)); wanted > 0;) {
    const double x = random.uniform(-width_m / 2, width_m / 2 - 0.5), y = random.uniform(-depth_m / 2, depth_m / 2 - 0.5);
    const double w = random.uniform(0.3, 1.2), d = random.uniform(0.3, 1.2);
    if (x < 0.8 && x + w > -0.8 && y < 0.8 && y + d > -0.8) continue;
    add_box(plan, x, y, std::min(x + w, width_m / 2), std::min(y + d, depth_m / 2));
    --wanted;
  }
  return plan;
}

/// A corridor with door niches every few metres, at random places on both sides.
Plan niched_corridor(RandomStream& random) {
  Plan plan;
  for (const double side : {-1.25, 1.25}) {
    double x = -60;
    while (x < 60) {
      const double door_m = x + random.uniform(3, 8), deep = side * 1.08;
      plan.push_back({{x, side}, {door_m, side}});
      plan.push_back({{door_m, side}, {door_m, deep}});
      plan.push_back({{door_m, deep}, {door_m + 0.9, deep}});
      plan.push_back({{door_m + 0.9, deep}, {door_m + 0.9, side}});
      x = door_m + 0.9;
    }
  }
  return plan;
}

/// Two smooth walls with small things along them: posts and cupboards that stand out by a hand's breadth or two.
Plan cluttered_corridor(RandomStream& random) {
  Plan plan = corridor();
  for (const double side : {-1.25, 1.25})
    for (double x = -60 + random.uniform(0, 6); x < 60; x += random.uniform(2, 9)) {
      const double wide = random.uniform(0.05, 0.5), inner = side - std::copysign(random.uniform(0.05, 0.4), side);
      add_box(plan, x, std::min(side, inner), x + wide, std::max(side, inner));
    }
  return plan;
}

double clearance_m(const Plan& plan, const Eigen::Vector2d& eye) {
  double nearest = 1e9;
  for (int k = 0; k < 36; ++k) nearest = std::min(nearest, cast_ray(plan, eye, k * kPi / 18, 100));
  return nearest;
}

/// A matcher that has driven into a plan, and what it says about one more step.
struct Drive {
  Drive(Plan where, const Pose2& start, std::uint64_t seed, int steps) : plan(std::move(where)), T_map_base(start), random(seed, RandomStreamId::kLaser) {
    matcher.match(look(), sensor, {});
    for (int k = 0; k < steps; ++k) step(wander());
  }
  Scan look() { return see(plan, sensor, T_map_base, &random); }
  /// A small motion that keeps away from everything.
  Pose2 wander() {
    for (;;) {
      const Pose2 motion(random.uniform(-0.02, 0.15), random.uniform(-0.01, 0.01), random.uniform(-0.12, 0.12));
      if (clearance_m(plan, (T_map_base * motion).translation()) > 0.35) return motion;
      T_map_base.heading += 0.3;  // a turn that odometry will not be told of is too small a trick: turn in earnest
      matcher.match(look(), sensor, {0, 0, 0.3});
    }
  }
  ScanMatch step(const Pose2& motion) {
    const Eigen::Matrix3d cov = odometry_covariance(motion, OdometryModelConfig());
    const Pose2 said(motion.x + 0.3 * std::sqrt(cov(0, 0)) * random.normal(), motion.y + 0.3 * std::sqrt(cov(1, 1)) * random.normal(),
                     motion.heading + 0.3 * std::sqrt(cov(2, 2)) * random.normal());
    return step(motion, said);
  }
  ScanMatch step(const Pose2& motion, const Pose2& odometry) {
    T_map_base = T_map_base * motion;
    return matcher.match(look(), sensor, odometry);
  }
  Plan plan;
  Pose2 T_map_base;
  RandomStream random;
  SensorInfo sensor = short_laser();
  ScanMatcher matcher{ScanMatcherConfig(), OdometryModelConfig()};
};

Eigen::Vector3d error_of(const ScanMatch& match, const Pose2& truth) {
  Eigen::Vector3d e = match.T_from_to.vector() - truth.vector();
  e[2] = wrap_angle(e[2]);
  return e;
}

int observed_directions(const Eigen::Matrix3d& information) {
  const Eigen::Matrix3d scale = Eigen::Vector3d(1, 1, 1.0 / 3).asDiagonal();
  const Eigen::Vector3d eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scale * information * scale).eigenvalues();
  return static_cast<int>((eigenvalues.array() > 1e-6 * eigenvalues[2]).count());
}

/// The error without its part in directions that the match says it did not observe.
Eigen::Vector3d claimed_part(const ScanMatch& match, const Eigen::Vector3d& e) {
  if (match.verdict != Verdict::kDegenerate) return e;
  const Eigen::Matrix3d scale = Eigen::Vector3d(1, 1, 1.0 / 3).asDiagonal(), unscale = Eigen::Vector3d(1, 1, 3).asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scale * match.information * scale);
  const Eigen::Vector3d seen = (solver.eigenvalues().array() > 1e-6 * solver.eigenvalues()[2]).cast<double>();
  return scale * solver.eigenvectors() * seen.asDiagonal() * solver.eigenvectors().transpose() * unscale * e;
}

struct Honesty {
  int matches = 0, accepted = 0, directions = 0;
  double nees = 0;
  void add(const ScanMatch& match, const Pose2& truth) {
    ++matches;
    if (!is_usable(match.verdict)) return;
    ++accepted;
    directions += observed_directions(match.information);
    const Eigen::Vector3d e = error_of(match, truth);
    nees += e.dot(match.information * e);
  }
  /// In units of three directions: 3 is right.
  double mean() const { return directions ? 3 * nees / directions : 0; }
};

Honesty drive_honestly(const std::function<Plan(RandomStream&)>& make_plan, int drives, int steps, std::uint64_t seed) {
  Honesty honesty;
  for (int k = 0; k < drives; ++k) {
    RandomStream random(seed + static_cast<std::uint64_t>(k), RandomStreamId::kOdometry);
    Drive drive(make_plan(random), {0, 0, random.uniform(-kPi, kPi)}, seed + 5000 + static_cast<std::uint64_t>(k), 5);
    for (int i = 0; i < steps; ++i) {
      const Pose2 motion = drive.wander();
      honesty.add(drive.step(motion), motion);
    }
  }
  return honesty;
}

struct Failures {
  int right = 0, refused = 0, silent = 0;
  void add(const ScanMatch& match, const Pose2& truth) {
    const Eigen::Vector3d e = claimed_part(match, error_of(match, truth));
    const bool wrong = e.head<2>().norm() > kWrong_m || std::abs(e[2]) > kWrong_rad;
    ++(!is_usable(match.verdict) ? refused : wrong ? silent : right);
  }
};

using Injection = std::function<void(std::uint64_t, Failures&)>;

/// Carried a little while odometry says that it stood.
void wrong_basin(std::uint64_t seed, Failures& failures) {
  RandomStream random(seed, RandomStreamId::kOdometry);
  Drive drive(random_room(random), {0, 0, random.uniform(-kPi, kPi)}, seed, 4);
  for (;;) {
    const Pose2 carried(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), random.uniform(-0.6, 0.6));
    if (clearance_m(drive.plan, (drive.T_map_base * carried).translation()) < 0.3) continue;
    return failures.add(drive.step(carried, {}), carried);
  }
}

/// Odometry slips by up to half a metre along a corridor, after a way of some metres or at its start.
void corridor_slide(std::uint64_t seed, Failures& failures) {
  RandomStream random(seed, RandomStreamId::kOdometry);
  const Plan plan = seed % 3 == 0 ? corridor() : seed % 3 == 1 ? niched_corridor(random) : cluttered_corridor(random);
  Drive drive(plan, {0, 0, random.uniform(-0.2, 0.2)}, seed, seed % 2 ? 4 : 40);
  const Pose2 motion(0.1, 0, 0);
  failures.add(drive.step(motion, motion * Pose2(random.uniform(-0.5, 0.5), 0, 0)), motion);
}

/// Carried into another room.
void kidnap(std::uint64_t seed, Failures& failures) {
  RandomStream random(seed, RandomStreamId::kOdometry);
  Drive drive(random_room(random), {0, 0, random.uniform(-kPi, kPi)}, seed, 4);
  drive.plan = random_room(random);
  const Pose2 elsewhere(30, 0, 0);  // how far does not matter: the plan is another
  drive.T_map_base = {0, 0, random.uniform(-kPi, kPi)};
  const ScanMatch match = drive.matcher.match(drive.look(), drive.sensor, {});
  failures.add(match, elsewhere);
}

/// A spin by 45 degrees beside a wall that odometry says nothing of.
void spin_beside_wall(std::uint64_t seed, Failures& failures) {
  RandomStream random(seed, RandomStreamId::kOdometry);
  Plan plan = random_room(random);
  plan.push_back({{-3, -0.4}, {3, -0.4}});
  Drive drive(plan, {0, 0, random.uniform(-0.3, 0.3)}, seed, 0);
  const Pose2 spin(0, 0, (seed % 2 ? 1 : -1) * random.uniform(0.7, 0.87));
  failures.add(drive.step(spin, {}), spin);
}

/// Carried from one corridor of doors into another that looks like it, with the niches elsewhere. What cannot be told from a scan is
/// where along the old corridor this would be; wrong is an answer that claims to know it and moves the robot there by more than 0.10 m.
void two_corridors(std::uint64_t seed, Failures& failures) {
  RandomStream random(seed, RandomStreamId::kOdometry);
  const auto plan = [&] { return seed % 2 ? niched_corridor(random) : cluttered_corridor(random); };
  Drive drive(plan(), {0, 0, random.uniform(-0.2, 0.2)}, seed, seed % 4 < 2 ? 4 : 40);
  drive.plan = plan();
  const Pose2 motion(0.1, 0, 0);
  ScanMatch match = drive.step(motion);
  const Eigen::Vector2d along = rotation(-drive.T_map_base.heading) * Eigen::Vector2d::UnitX();
  const Eigen::Vector3d direction(along.x(), along.y(), 0);
  const bool claims_along = direction.dot(match.information * direction) > 1 / (kWrong_m * kWrong_m);
  const bool moved = std::abs(direction.dot(error_of(match, motion))) > kWrong_m;
  ++(!is_usable(match.verdict) ? failures.refused : claims_along && moved ? failures.silent : failures.right);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Is the scan matcher's opinion of itself right?");
  std::string json_path, markdown_path;
  int each = 2000, drives = 100;
  app.add_option("--json", json_path, "also write the figures here");
  app.add_option("--markdown", markdown_path, "and as a table here");
  app.add_option("--each", each, "injections of each kind")->check(CLI::PositiveNumber);
  app.add_option("--drives", drives, "drives of 20 matches in rooms, and in corridors")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);

  nlohmann::json json;
  std::string table = "| drives | matches | accepted | NEES in units of three observed directions (3 is right) | false alarms |\n|---|---|---|---|---|\n";
  const auto honesty_row = [&](const char* name, const Honesty& h) {
    char row[200];
    const double alarms = 100.0 * (h.matches - h.accepted) / h.matches;
    std::snprintf(row, sizeof row, "| %s | %d | %d | %.2f | %.2f %% |\n", name, h.matches, h.accepted, h.mean(), alarms);
    table += row;
    json["honesty"][name] = {{"matches", h.matches}, {"accepted", h.accepted}, {"nees", h.mean()}, {"false_alarms_percent", alarms}};
  };
  honesty_row("furnished rooms", drive_honestly(random_room, drives, 20, 1000));
  honesty_row("corridors with niches", drive_honestly(niched_corridor, drives, 20, 2000));
  honesty_row("corridors with small things", drive_honestly(cluttered_corridor, drives, 60, 4000));
  honesty_row("bare corridor", drive_honestly([](RandomStream&) { return corridor(); }, drives / 4 + 1, 20, 3000));

  table += "\n| injected failure | right | refused | silent |\n|---|---|---|---|\n";
  const std::vector<std::pair<const char*, Injection>> kinds = {{"carried up to 1 m and 34 deg", wrong_basin},
                                                               {"slip along a corridor", corridor_slide},
                                                               {"carried into another room", kidnap},
                                                               {"spin by 45 deg beside a wall", spin_beside_wall},
                                                               {"carried between two corridors", two_corridors}};
  int silent = 0;
  for (const auto& [name, inject] : kinds) {
    Failures failures;
    for (int k = 0; k < each; ++k) inject(10000 + static_cast<std::uint64_t>(k), failures);
    char row[200];
    std::snprintf(row, sizeof row, "| %s | %d | %d | %d |\n", name, failures.right, failures.refused, failures.silent);
    table += row;
    json["failures"][name] = {{"right", failures.right}, {"refused", failures.refused}, {"silent", failures.silent}};
    silent += failures.silent;
  }
  std::cout << table;
  if (!json_path.empty()) std::ofstream(json_path) << json.dump(2) << "\n";
  if (!markdown_path.empty()) std::ofstream(markdown_path) << table;
  return silent == 0 ? 0 : 1;
}
