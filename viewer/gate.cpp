// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gate.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace modslam {
namespace {

constexpr std::size_t kShortestToken = 16;

/// Takes as long wherever the first difference is.
bool equal_slowly(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^
                  static_cast<unsigned>(
                      static_cast<unsigned char>(b[i % std::max<std::size_t>(1, b.size())]));
  return difference == 0;
}

}  // namespace

bool is_own_page(const std::string& host, const std::string& origin) {
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != std::string::npos && host.find(']', colon) == std::string::npos;
  const std::string name = host.substr(0, has_port ? colon : host.size());
  const bool loopback = name == "127.0.0.1" || name == "localhost" || name == "[::1]";
  return loopback && (origin.empty() || origin == "http://" + host);
}

Gate::Gate(const std::string& address, std::string token) {
  if (address == "127.0.0.1") return;
  if (token.size() < kShortestToken)
    throw std::runtime_error("viewer.host = " + address +
                             " lets others look: set MODSLAM_TOKEN to a secret of at least 16 "
                             "characters first, or use ssh -L instead");
  token_ = std::move(token);
}

bool Gate::admits(const std::string& host, const std::string& origin,
                  const std::string& query) const {
  if (!open_to_others()) return is_own_page(host, origin);
  const bool same_origin = origin.empty() || origin == "http://" + host;
  return same_origin && equal_slowly(token_, query_value(query, "token").value_or(""));
}

std::optional<std::string> query_value(const std::string& query, const std::string& key) {
  for (std::size_t begin = 0; begin < query.size();) {
    const std::size_t end = std::min(query.find('&', begin), query.size());
    if (query.compare(begin, key.size() + 1, key + "=") == 0)
      return query.substr(begin + key.size() + 1, end - begin - key.size() - 1);
    begin = end + 1;
  }
  return std::nullopt;
}

bool RateLimit::take() {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - last_).count();
  last_ = now;
  left_ = std::min(at_once_, left_ + passed_s * per_second_);
  if (left_ < 1) return false;
  left_ -= 1;
  return true;
}

bool Wishes::add(const std::string& text) {
  const std::string speed = "speed ";
  if (text.rfind(speed, 0) == 0) {
    char* end = nullptr;
    const double times = std::strtod(text.c_str() + speed.size(), &end);
    if (text.size() > 16 || *end != '\0' || !(times >= 0.1 && times <= 20)) return false;
  } else if (text != "play" && text != "pause" && text != "step") {
    return false;
  }
  const std::lock_guard lock(mutex_);
  if (waiting_.size() < kMost) waiting_.push_back(text);
  return true;
}

std::optional<std::string> Wishes::take() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  std::string first = std::move(waiting_.front());
  waiting_.pop_front();
  return first;
}

}  // namespace modslam
