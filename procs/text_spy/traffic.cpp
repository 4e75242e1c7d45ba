// SPDX-License-Identifier: BSD-3-Clause
#include "procs/text_spy/traffic.hpp"

#include <algorithm>

namespace modslam {

void Traffic::add(const std::string& channel, const void* bytes, std::size_t size, double now_s,
                  std::int64_t number) {
  if (channels_.size() >= kMostChannels && !channels_.count(channel)) return;
  ChannelTraffic& c = channels_[channel];
  if (c.messages > 0) c.longest_s = std::max(c.longest_s, now_s - c.last_s);
  if (number >= 0) {
    if (c.last_number >= 0 && number > c.last_number + 1) c.missing += number - c.last_number - 1;
    c.last_number = number;
  }
  ++c.messages;
  c.bytes += static_cast<std::int64_t>(size);
  c.last_s = now_s;
  const auto* begin = static_cast<const std::uint8_t*>(bytes);
  c.newest.assign(begin, begin + size);
  c.recent.emplace_back(now_s, size);
  while (c.recent.front().first < now_s - kWindow_s) c.recent.pop_front();
}

std::pair<double, double> Traffic::rate(const ChannelTraffic& channel, double now_s) {
  double messages = 0, bytes = 0;
  for (const auto& [when_s, size] : channel.recent)
    if (when_s >= now_s - kWindow_s) messages += 1, bytes += static_cast<double>(size);
  return {messages / kWindow_s, bytes / kWindow_s};
}

}  // namespace modslam
