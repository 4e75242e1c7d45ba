// SPDX-License-Identifier: BSD-3-Clause
/// relocalize-bench LOG.lcm RUN [--starts N] [--markdown FILE]: how often a robot that knows nothing is placed, and how often wrongly.
///
/// The map are the scans of the first half of the log at the poses of RUN/path.tum. From N places of the second half the robot starts with an odometry frame turned and
/// shifted at random, drives up to 20 m, and asks with every scan. An answer is right within 0.3 m and 5 degrees of the run's own path.
/// Starts outside of what the first half saw (no node within 2 m) are counted apart: any answer there that is not right is a wrong one.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <bot_core/planar_lidar_t.hpp>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <modslam/sensor_info_t.hpp>
#include <random>
#include <sstream>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/log.hpp"
#include "common/loops/relocalizer.hpp"

using namespace modslam;

namespace {

struct Shot {
  Scan scan;
  Pose2 T_map_base;
};

std::vector<Shot> read_shots(const std::string& log, const std::string& run, SensorInfo& sensor) {
  std::vector<Shot> shots;
  std::ifstream path(run + "/path.tum");
  LogReader reader(log);
  std::string line;
  for (LogEvent event; reader.next(event);) {
    sensor_info_t info{};
    bot_core::planar_lidar_t laser{};
    const auto decode = [&](auto& message) { return message.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())) >= 0; };
    if (event.channel == channel::kSensorInfo && decode(info) && info.sensor == channel::kLaser) sensor = to_sensor_info(info);
    if (event.channel != channel::kLaser || !decode(laser)) continue;
    if (!std::getline(path, line)) break;
    double time_s = 0, x = 0, y = 0, z = 0, qx = 0, qy = 0, qz = 0, qw = 1;
    std::istringstream(line) >> time_s >> x >> y >> z >> qx >> qy >> qz >> qw;
    shots.push_back({to_scan(laser), {x, y, 2 * std::atan2(qz, qw)}});
  }
  return shots;
}

struct Tally {
  int starts = 0, right = 0, wrong = 0, silent = 0;
  std::vector<double> way_m;
};

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Places a robot that knows nothing in the map of an earlier run.");
  std::string log, run, markdown;
  int starts = 100;
  app.add_option("log", log)->required();
  app.add_option("run", run)->required();
  app.add_option("--starts", starts);
  app.add_option("--markdown", markdown);
  CLI11_PARSE(app, argc, argv);

  SensorInfo sensor;
  const std::vector<Shot> shots = read_shots(log, run, sensor);
  const std::size_t half = shots.size() / 2;
  Relocalizer map(0.012, 40.0);
  std::vector<Pose2> nodes;
  for (std::size_t k = 0; k < half; ++k)
    if (nodes.empty() || distance(nodes.back(), shots[k].T_map_base) > 0.3 || std::abs(wrap_angle(nodes.back().heading - shots[k].T_map_base.heading)) > 0.35) {
      map.add_node(static_cast<NodeId>(nodes.size()), shots[k].T_map_base, shots[k].scan, sensor);
      nodes.push_back(shots[k].T_map_base);
    }

  std::mt19937 random(1);
  std::uniform_real_distribution<double> metres(-50, 50), radians(-kPi, kPi);
  Tally known, unknown;
  int looks = 0;
  const std::clock_t begin = std::clock();
  for (int s = 0; s < starts; ++s) {
    const std::size_t first = half + (shots.size() - half) * static_cast<std::size_t>(s) / static_cast<std::size_t>(starts);
    const Pose2 T_track_map(metres(random), metres(random), radians(random));
    const bool is_known = std::any_of(nodes.begin(), nodes.end(), [&](const Pose2& node) { return distance(node, shots[first].T_map_base) < 2; });
    Tally& tally = is_known ? known : unknown;
    ++tally.starts;
    map.forget();
    double way_m = 0;
    bool answered = false;
    for (std::size_t k = first; k < shots.size() && way_m < 20 && !answered; ++k) {
      if (k > first) way_m += distance(shots[k - 1].T_map_base, shots[k].T_map_base);
      const Relocalizer::Answer answer = map.look(shots[k].scan, sensor, T_track_map * shots[k].T_map_base);
      looks += answer.scans > 0;
      if (answer.verdict != Verdict::kOk) continue;
      answered = true;
      const Pose2 d = between(shots[k].T_map_base, answer.T_map_base);
      const bool right = std::hypot(d.x, d.y) < 0.3 && std::abs(d.heading) < 0.087;
      (right ? tally.right : tally.wrong) += 1;
      tally.way_m.push_back(way_m);
      if (!right)
        std::cerr << "wrong at scan " << k << ": off by " << d.x << " " << d.y << " m " << d.heading << " rad, posterior " << answer.posterior << ", overlap "
                  << answer.overlap << ", " << answer.scans << " scans\n";
    }
    tally.silent += !answered;
  }
  const double cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::ostringstream table;
  table << std::fixed << std::setprecision(2);
  table << "| start | starts | placed right | wrong | not placed within 20 m | way until placed, median [m] |\n|---|---|---|---|---|---|\n";
  for (auto* tally : {&known, &unknown}) {
    std::sort(tally->way_m.begin(), tally->way_m.end());
    table << (tally == &known ? "| in the map | " : "| outside | ") << tally->starts << " | " << tally->right << " | " << tally->wrong << " | " << tally->silent
          << " | " << (tally->way_m.empty() ? 0.0 : tally->way_m[tally->way_m.size() / 2]) << " |\n";
  }
  std::cout << table.str() << "CPU seconds in all: " << cpu_s << ", a start: " << cpu_s / starts << "\n";
  if (!markdown.empty()) std::ofstream(markdown) << table.str();
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << std::endl;
  return 1;
}
