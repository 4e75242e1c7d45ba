// SPDX-License-Identifier: BSD-3-Clause
/// @file What waits to be sent to one page. A slow page gets fewer updates, never a growing queue.
#pragma once
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

namespace modslam {

/// One WebSocket message: JSON text or a binary tile (README.md has the format).
struct Frame {
  bool binary = false;
  std::string bytes;
};
using FramePtr = std::shared_ptr<const Frame>;

/// Holds at most one frame a stream: a newer one takes the place of the one that waits, so its
/// length is bounded by the number of streams and no stream can starve another. Safe to use from
/// several threads.
class Outbox {
 public:
  void put(const std::string& stream, FramePtr frame);
  /// Waits for the frame that has waited longest. @return nothing after `timeout` or once closed.
  std::optional<FramePtr> take(std::chrono::milliseconds timeout);
  /// Forgets what waits.
  void clear();
  /// Wakes take() for good.
  void close();
  bool closed() const;
  std::size_t size() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable filled_;
  std::deque<std::string> order_;  ///< streams, longest wait first
  std::unordered_map<std::string, FramePtr> waiting_;
  bool closed_ = false;
};

}  // namespace modslam
