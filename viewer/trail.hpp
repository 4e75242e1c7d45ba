// SPDX-License-Identifier: BSD-3-Clause
/// @file A long list of poses, sent in pieces so that a change costs one piece.
#pragma once
#include <array>
#include <set>
#include <string>
#include <vector>

#include "common/geometry/pose2.hpp"
#include "viewer/hub.hpp"

namespace modslam {

/// Three numbers: x [m], y [m], heading [rad] of a pose, or the axes of an ellipse.
using Triple = std::array<double, 3>;
inline Triple triple(const Pose2& pose) { return {pose.x, pose.y, pose.heading}; }

/// Triples 0, 1, 2, ... of stream `name`; piece k holds numbers k * kPiece and following, as stream
/// "name/k"; one that is not full is the last.
class Trail {
 public:
  static constexpr std::size_t kPiece = 256;

  explicit Trail(std::string name) : name_(std::move(name)) {}

  /// Changes number `index`, or appends it when it is the next.
  void set(std::size_t index, const Triple& triple);
  void append(const Triple& triple) { set(triples_.size(), triple); }
  void clear();
  /// Empties the list; pages are told at the next flush.
  void start_over();
  /// Publishes the pieces that changed since the last call, as of message time `utime`.
  void flush(Hub& hub, std::int64_t utime);
  const std::vector<Triple>& triples() const { return triples_; }

 private:
  std::string name_;
  std::vector<Triple> triples_;
  std::set<std::size_t> changed_;
};

}  // namespace modslam
