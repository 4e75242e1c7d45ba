// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/outbox.hpp"

namespace modslam {

void Outbox::put(const std::string& stream, FramePtr frame) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    if (waiting_.insert_or_assign(stream, std::move(frame)).second) order_.push_back(stream);
  }
  filled_.notify_one();
}

std::optional<FramePtr> Outbox::take(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  filled_.wait_for(lock, timeout, [this] { return closed_ || !order_.empty(); });
  if (closed_ || order_.empty()) return std::nullopt;
  const auto oldest = waiting_.find(order_.front());
  FramePtr frame = std::move(oldest->second);
  waiting_.erase(oldest);
  order_.pop_front();
  return frame;
}

void Outbox::clear() {
  const std::lock_guard lock(mutex_);
  order_.clear();
  waiting_.clear();
}

void Outbox::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  filled_.notify_all();
}

bool Outbox::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

std::size_t Outbox::size() const {
  const std::lock_guard lock(mutex_);
  return order_.size();
}

}  // namespace modslam
