// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "common/config/visitor.hpp"

namespace modslam {

/// The player of logs that a person can drive; the launcher sets the log.
struct PlayerConfig {
  static constexpr const char* kTable = "player";
  std::string log = "run.lcm";
  double speed = 1.0;
  bool paused = false;

  void visit(ConfigVisitor& v) {
    v.text("log", log, "LCM log whose sensor channels are played.");
    v.number("speed", speed, 0.1, 20.0, "", "Times real time at the start.");
    v.flag("paused", paused, "Wait for a person to press play.");
  }
};

}  // namespace modslam
