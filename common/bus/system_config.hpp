// SPDX-License-Identifier: BSD-3-Clause
/// @file All configuration structs, one a table of config/modslam.toml.
#pragma once
#include <string>

#include "common/bus/journal.hpp"
#include "common/config/player.hpp"
#include "common/config/viewer.hpp"
#include "common/config/visitor.hpp"
#include "common/graph/estimator.hpp"
#include "common/loops/loop_detector.hpp"
#include "common/maps/map_builder.hpp"
#include "common/matching/scan_matcher.hpp"
#include "common/motion/odometry_model.hpp"
#include "common/places/places_config.hpp"
#include "common/semantics/semantics_config.hpp"
#include "common/world/ins_noise.hpp"
#include "common/world/laser_noise.hpp"
#include "common/world/odometry_noise.hpp"
#include "common/world/world_simulation.hpp"

namespace modslam {

/// What is decided when a run is launched.
struct LaunchConfig {
  static constexpr const char* kTable = "launch";
  std::string estimator = "graph_optimizer";
  std::string map;
  bool loops = true;
  bool semantics = true;
  bool viewer = true;
  bool lockstep = false;

  void visit(ConfigVisitor& v) {
    v.choice("estimator", estimator, {"graph_optimizer", "localizer", "odometry", "ground_truth"},
             "Who estimates the pose: the graph, a saved map, or one of two yardsticks.");
    v.text("map", map, "Folder of the run whose map the localizer uses; run.sh replay --map DIR --localize-only sets it.");
    v.flag("loops", loops, "Start the loop detector.");
    v.flag("semantics", semantics, "Start the semantic classifier.");
    v.flag("viewer", viewer, "Start the viewer (a web page on 127.0.0.1).");
    v.flag("lockstep", lockstep, "The estimator waits for the loop detector after each node; run.sh sets it for fast replays.");
  }
};

/// Where a run is recorded; the launcher sets it.
struct RecorderConfig {
  static constexpr const char* kTable = "recorder";
  std::string path = "run.lcm";

  void visit(ConfigVisitor& v) { v.text("path", path, "LCM log that everything on the bus is written to."); }
};

struct SystemConfig {
  LaunchConfig launch;
  OdometryModelConfig odometry_model;
  ScanMatcherConfig scan_matcher;
  EstimatorConfig graph_optimizer;
  LoopDetectorConfig loop_detector;
  MapBuilderConfig map_builder;
  SemanticsConfig semantics;
  PlacesConfig places;
  RecorderConfig recorder;
  JournalConfig journal;
  ViewerConfig viewer;
  PlayerConfig player;
  SimulatorConfig simulator;
  LaserConfig laser;
  OdometryConfig odometry;
  InsConfig ins;

  /// Calls visit(table) for each struct, in the order of the file.
  template <class Visit>
  void each(Visit&& visit) {
    visit(launch);
    visit(odometry_model);
    visit(scan_matcher);
    visit(graph_optimizer);
    visit(loop_detector);
    visit(map_builder);
    visit(semantics);
    visit(places);
    visit(recorder);
    visit(journal);
    visit(viewer);
    visit(player);
    visit(simulator);
    visit(laser);
    visit(odometry);
    visit(ins);
  }
};

}  // namespace modslam
