// SPDX-License-Identifier: BSD-3-Clause
/// @file Counts what passes on a bus: rate, bandwidth and gaps of every channel.
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

namespace modslam {

struct ChannelTraffic {
  std::int64_t messages = 0, bytes = 0;
  std::int64_t missing = 0;       ///< holes in the numbers of a numbered stream
  std::int64_t last_number = -1;  ///< -1: the stream is not numbered, or nothing came yet
  double longest_s = 0;           ///< longest silence between two messages
  double last_s = 0;              ///< when the newest came
  std::vector<std::uint8_t> newest;
  std::deque<std::pair<double, std::size_t>> recent;  ///< (when, bytes) of the last kWindow_s
};

class Traffic {
 public:
  static constexpr double kWindow_s = 3.0;
  static constexpr std::size_t kMostChannels = 500;

  /// @param now_s   a steady clock.
  /// @param number  of the message in its stream; -1 when it has none. A number that steps back
  /// begins anew.
  void add(const std::string& channel, const void* bytes, std::size_t size, double now_s,
           std::int64_t number = -1);
  /// Messages and bytes a second over the window that ends now.
  static std::pair<double, double> rate(const ChannelTraffic& channel, double now_s);
  const std::map<std::string, ChannelTraffic>& channels() const { return channels_; }

 private:
  std::map<std::string, ChannelTraffic> channels_;
};

}  // namespace modslam
