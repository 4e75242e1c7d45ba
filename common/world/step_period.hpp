// SPDX-License-Identifier: BSD-3-Clause
/// @file Every how many simulated steps a sensor speaks, and what a step's number says about the order of states.
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

/// Tells a simulation that began anew from a state that the network delivered late.
class StepOrder {
 public:
  enum class Kind {
    kAnew,      ///< the first of all, or far behind the newest: the simulation was started again
    kNext,      ///< ahead of the newest; skipped() steps lie between
    kRepeated,  ///< the newest once more
    kLate       ///< at most kLate_steps behind the newest: its time has passed
  };
  static constexpr std::int64_t kLate_steps = 100;

  Kind see(std::int64_t step) {
    skipped_ = 0;
    if (step == newest_) return Kind::kRepeated;
    if (newest_ >= 0 && step < newest_ && newest_ - step <= kLate_steps) return Kind::kLate;
    const bool anew = newest_ < 0 || step < newest_;
    if (!anew) skipped_ = step - newest_ - 1;
    newest_ = step;
    return anew ? Kind::kAnew : Kind::kNext;
  }

  std::int64_t skipped() const { return skipped_; }
  std::int64_t newest() const { return newest_; }

 private:
  std::int64_t newest_ = -1, skipped_ = 0;
};

}  // namespace modslam
