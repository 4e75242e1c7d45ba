// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/hub.hpp"

namespace modslam {

void Hub::publish(const std::string& stream, FramePtr frame) {
  const std::lock_guard lock(mutex_);
  newest_[stream] = frame;
  for (const auto& outbox : outboxes_) outbox->put(stream, frame);
}

void Hub::publish_kept(const std::string& stream, std::int64_t utime, FramePtr frame) {
  history_.add(stream, utime, frame);
  publish(stream, std::move(frame));
}

void Hub::restart(const std::string& kept_prefix) {
  history_.clear();
  const std::lock_guard lock(mutex_);
  for (auto it = newest_.begin(); it != newest_.end();)
    it = it->first.rfind(kept_prefix, 0) == 0 ? std::next(it) : newest_.erase(it);
  for (const auto& outbox : outboxes_) {
    outbox->clear();
    fill(*outbox);
  }
}

std::shared_ptr<Outbox> Hub::join() {
  auto outbox = std::make_shared<Outbox>();
  const std::lock_guard lock(mutex_);
  fill(*outbox);
  outboxes_.insert(outbox);
  return outbox;
}

void Hub::leave(const std::shared_ptr<Outbox>& outbox) {
  outbox->close();
  const std::lock_guard lock(mutex_);
  outboxes_.erase(outbox);
}

std::size_t Hub::pages() const {
  const std::lock_guard lock(mutex_);
  return outboxes_.size();
}

std::size_t Hub::streams() const {
  const std::lock_guard lock(mutex_);
  return newest_.size();
}

void Hub::fill(Outbox& outbox) const {
  outbox.put("hello", hello_);
  for (const auto& [stream, frame] : newest_) outbox.put(stream, frame);
}

}  // namespace modslam
