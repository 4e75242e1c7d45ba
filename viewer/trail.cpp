// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/trail.hpp"

#include <algorithm>
#include <cassert>

#include "viewer/frames.hpp"

namespace modslam {

void Trail::set(std::size_t index, const Pose2& pose) {
  assert(index <= poses_.size());
  if (index == poses_.size())
    poses_.push_back(pose);
  else
    poses_[index] = pose;
  changed_.insert(index / kPiece);
}

void Trail::clear() {
  poses_.clear();
  changed_.clear();
}

void Trail::flush(Hub& hub) {
  for (const std::size_t piece : changed_) {
    const auto begin = poses_.begin() + static_cast<std::ptrdiff_t>(piece * kPiece);
    const auto end =
        poses_.begin() + static_cast<std::ptrdiff_t>(std::min(poses_.size(), (piece + 1) * kPiece));
    hub.publish(name_ + "/" + std::to_string(piece),
                text_frame(poses_json(name_.c_str(), piece * kPiece, {begin, end})));
  }
  changed_.clear();
}

}  // namespace modslam
