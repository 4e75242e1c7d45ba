// SPDX-License-Identifier: BSD-3-Clause
/// @file A long list of poses, sent in pieces so that a change costs one piece.
#pragma once
#include <set>
#include <string>
#include <vector>

#include "common/geometry/pose2.hpp"
#include "viewer/hub.hpp"

namespace modslam {

/// Poses 0, 1, 2, ... of stream `name`; piece k holds poses k * kPiece and following, as stream
/// "name/k".
class Trail {
 public:
  static constexpr std::size_t kPiece = 256;

  explicit Trail(std::string name) : name_(std::move(name)) {}

  /// Changes pose `index`, or appends it when it is the next.
  void set(std::size_t index, const Pose2& pose);
  void append(const Pose2& pose) { set(poses_.size(), pose); }
  void clear();
  /// Publishes the pieces that changed since the last call.
  void flush(Hub& hub);
  const std::vector<Pose2>& poses() const { return poses_; }

 private:
  std::string name_;
  std::vector<Pose2> poses_;
  std::set<std::size_t> changed_;
};

}  // namespace modslam
