// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/history.hpp"

#include <algorithm>

namespace modslam {
namespace {

constexpr std::int64_t kLongestInterval_us = std::int64_t{3600} * 1'000'000;
constexpr std::size_t kOverhead = 96;  // bytes of a version beside its frame

std::size_t cost(const FramePtr& frame) { return frame->bytes.size() + kOverhead; }

}  // namespace

void History::add(const std::string& stream, std::int64_t utime, FramePtr frame) {
  const std::lock_guard lock(mutex_);
  if (extent_.begin_utime == 0) extent_.begin_utime = utime;  // 0: before the run had a time
  extent_.end_utime = std::max(extent_.end_utime, utime);
  utime = extent_.end_utime;
  extent_.bytes += cost(frame);
  std::vector<Version>& versions = streams_[stream];
  const auto slot = [this](std::int64_t t) { return t / extent_.interval_us; };
  if (!versions.empty() && slot(versions.back().utime) == slot(utime)) {
    extent_.bytes -= cost(versions.back().frame);
    versions.back() = {utime, std::move(frame)};
  } else {
    versions.push_back({utime, std::move(frame)});
  }
  while (extent_.bytes > budget_bytes_ && extent_.interval_us < kLongestInterval_us) thin();
}

void History::thin() {
  extent_.interval_us *= 2;
  extent_.bytes = 0;
  for (auto& [stream, versions] : streams_) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < versions.size(); ++i) {
      const bool last_of_slot =
          i + 1 == versions.size() ||
          versions[i].utime / extent_.interval_us != versions[i + 1].utime / extent_.interval_us;
      if (!last_of_slot) continue;
      extent_.bytes += cost(versions[i].frame);
      if (kept != i) versions[kept] = std::move(versions[i]);
      ++kept;
    }
    versions.resize(kept);
  }
}

void History::clear() {
  const std::lock_guard lock(mutex_);
  streams_.clear();
  extent_ = {};
}

std::vector<FramePtr> History::at(std::int64_t utime) const {
  const std::lock_guard lock(mutex_);
  std::vector<FramePtr> frames;
  for (const auto& [stream, versions] : streams_) {
    const auto later =
        std::upper_bound(versions.begin(), versions.end(), utime,
                         [](std::int64_t t, const Version& version) { return t < version.utime; });
    if (later != versions.begin()) frames.push_back(std::prev(later)->frame);
  }
  return frames;
}

History::Extent History::extent() const {
  const std::lock_guard lock(mutex_);
  return extent_;
}

}  // namespace modslam
