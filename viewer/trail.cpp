// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/trail.hpp"

#include <algorithm>
#include <cassert>

#include "viewer/frames.hpp"

namespace modslam {

void Trail::set(std::size_t index, const Triple& triple) {
  assert(index <= triples_.size());
  if (index == triples_.size())
    triples_.push_back(triple);
  else
    triples_[index] = triple;
  changed_.insert(index / kPiece);
}

void Trail::clear() {
  triples_.clear();
  changed_.clear();
}

void Trail::start_over() {
  for (std::size_t piece = 0; piece * kPiece < triples_.size(); ++piece) changed_.insert(piece);
  triples_.clear();
}

void Trail::flush(Hub& hub, std::int64_t utime) {
  for (const std::size_t piece : changed_) {
    const auto begin = triples_.begin() +
                       static_cast<std::ptrdiff_t>(std::min(triples_.size(), piece * kPiece));  // an empty piece: there are fewer now
    const auto end = triples_.begin() +
                     static_cast<std::ptrdiff_t>(std::min(triples_.size(), (piece + 1) * kPiece));
    hub.publish_kept(name_ + "/" + std::to_string(piece), utime,
                     text_frame(poses_json(name_.c_str(), piece * kPiece, {begin, end})));
  }
  changed_.clear();
}

}  // namespace modslam
