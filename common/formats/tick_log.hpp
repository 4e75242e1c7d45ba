// SPDX-License-Identifier: BSD-3-Clause
/// @file Lines of the CoreSLAM recordings (Mines ParisTech): wheel ticks and a sweep of a URG-04LX, numbers only, no first word.
///
/// A line: stamp [us], a word, left and right wheel ticks, 20 words of other sensors, ranges [mm] from right to left, 0 for a missing
/// return. The file tells nothing of the robot, so what its makers publish with it stands in tick_log.cpp.
#pragma once
#include <optional>

#include "common/formats/recording.hpp"
#include "common/formats/text_fields.hpp"

namespace modslam {

/// Sums wheel ticks up to a pose, line after line.
class TickLog {
 public:
  /// One line, nothing of it read yet. @throws BadLine; then `recording` is unchanged.
  void read(TextFields& fields, Recording& recording);

 private:
  struct Ticks {
    std::int64_t left, right;
  };
  std::optional<Ticks> last_;
  Pose2 T_odom_base_;
};

}  // namespace modslam
