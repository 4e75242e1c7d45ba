// SPDX-License-Identifier: BSD-3-Clause
/// @file The newest frame of every stream, and the outboxes of the pages that look.
#pragma once
#include <map>
#include <set>

#include "viewer/history.hpp"
#include "viewer/outbox.hpp"

namespace modslam {

/// One thread publishes, many join and leave. A page that joins gets HELLO (forget what you know)
/// and the newest frame of every stream.
class Hub {
 public:
  /// `hello` is what a page gets first.
  explicit Hub(FramePtr hello, std::size_t history_bytes = 0)
      : history_(history_bytes), hello_(std::move(hello)) {}

  void publish(const std::string& stream, FramePtr frame);
  /// The same, and it is kept: part of the run's past at message time `utime`.
  void publish_kept(const std::string& stream, std::int64_t utime, FramePtr frame);
  /// Forgets all streams but those whose name begins with `kept_prefix`; every page starts anew.
  void restart(const std::string& kept_prefix);

  std::shared_ptr<Outbox> join();
  void leave(const std::shared_ptr<Outbox>& outbox);

  std::size_t pages() const;
  std::size_t streams() const;
  const History& history() const { return history_; }

 private:
  void fill(Outbox& outbox) const;

  History history_;
  mutable std::mutex mutex_;
  FramePtr hello_;
  std::map<std::string, FramePtr> newest_;
  std::set<std::shared_ptr<Outbox>> outboxes_;
};

}  // namespace modslam
