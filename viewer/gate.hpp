// SPDX-License-Identifier: BSD-3-Clause
/// @file Who may look, how often, and what a page may ask for.
#pragma once
#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace modslam {

/// Whether a request may be answered: it was sent to a loopback name (so no foreign name was
/// rebound to this machine) and, when a browser says where it comes from, it comes from that very
/// address.
/// @param host    header Host, e.g. "127.0.0.1:8080"; with port forwarding the port is the
/// forwarded one.
/// @param origin  header Origin, e.g. "http://127.0.0.1:8080"; empty: not from a web page.
bool is_own_page(const std::string& host, const std::string& origin);

/// A server that others can reach serves only who knows its token.
class Gate {
 public:
  /// @throws std::runtime_error when `address` is not 127.0.0.1 and `token` is shorter than 16
  /// characters.
  Gate(const std::string& address, std::string token);

  bool open_to_others() const { return !token_.empty(); }
  /// @param query  of the request, e.g. "token=abc&utime=5".
  bool admits(const std::string& host, const std::string& origin, const std::string& query) const;

 private:
  std::string token_;  ///< "": this machine alone
};

/// Value of `key` in a query string, as it stands there.
std::optional<std::string> query_value(const std::string& query, const std::string& key);

/// So many requests a second in the mean, some more at once. Safe to use from several threads.
class RateLimit {
 public:
  RateLimit(double per_second, double at_once)
      : per_second_(per_second), at_once_(at_once), left_(at_once) {}
  bool take();

 private:
  using Clock = std::chrono::steady_clock;
  std::mutex mutex_;
  double per_second_, at_once_, left_;
  Clock::time_point last_ = Clock::now();
};

/// What pages ask of the player, at most kMost waiting. Safe to use from several threads.
class Wishes {
 public:
  static constexpr std::size_t kMost = 32;

  /// @return false when `text` is no wish: play, pause, step, or speed and a number 0.1 to 20.
  bool add(const std::string& text);
  std::optional<std::string> take();

 private:
  std::mutex mutex_;
  std::deque<std::string> waiting_;
};

}  // namespace modslam
