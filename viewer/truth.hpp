// SPDX-License-Identifier: BSD-3-Clause
/// @file The true path, laid over the map.
#pragma once
#include <deque>
#include <optional>

#include "common/bus/conversions.hpp"
#include "viewer/path_sketch.hpp"

namespace modslam {

/// Ground truth speaks of its own frame. The first estimated pose with a true one beside it ties
/// the two frames together, once: from there on the distance between the paths is the estimator's
/// error.
class Truth {
 public:
  void add(const TimedPose& T_world_base);
  /// @return the distance to the true position [m]; nothing when no true pose lies beside it.
  std::optional<double> add_estimate(std::int64_t utime, const Pose2& T_map_base);
  void clear();
  void flush(Hub& hub, std::int64_t utime) { trail_.flush(hub, utime); }
  const std::vector<Triple>& trail() const { return trail_.triples(); }

 private:
  void extend(const Pose2& T_world_base) { sketch_.add(triple(*T_map_world_ * T_world_base)); }

  std::deque<TimedPose> recent_;  ///< newest last
  std::optional<Pose2> T_map_world_;
  Trail trail_{"truth"};
  PathSketch sketch_{trail_};
};

}  // namespace modslam
