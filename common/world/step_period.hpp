// SPDX-License-Identifier: BSD-3-Clause
/// @file Every how many simulated steps a sensor speaks.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace modslam {

/// Robust to steps that were lost on the way: the first step seen in each period is due.
class StepPeriod {
 public:
  /// @param steps_per_s  of the simulation; the period is rounded to whole steps, at least one.
  StepPeriod(double rate_hz, double steps_per_s)
      : period_(std::max<std::int64_t>(1, std::llround(steps_per_s / rate_hz))) {}

  /// Call once for each step. A step back means that the simulation began anew: due.
  bool due(std::int64_t step) {
    const bool now = last_ < 0 || step < last_ || step / period_ > last_ / period_;
    last_ = step;
    return now;
  }

 private:
  std::int64_t period_, last_ = -1;
};

}  // namespace modslam
