// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/loss_meter.hpp"

#include <algorithm>

#include "common/bus/channels.hpp"

namespace modslam {
namespace {

bool has_many_speakers(const std::string& name) {
  return name == channel::kStatus || name == channel::kParameters || name == channel::kCommand || name == channel::kSyncRequest;
}

}  // namespace

std::vector<std::string> LossMeter::take(const process_status_t& status, Bus& bus) {
  std::vector<std::string> more;
  for (const channel_count_t& out : status.outputs) {
    const auto in = bus.inputs().find(out.channel);
    if (has_many_speakers(out.channel) || in == bus.inputs().end()) continue;
    Sender& sender = by_channel_[out.channel];
    if (sender.pid != status.pid || out.received < sender.sent) {
      sender = {status.pid, out.received, in->second.received, 0, sender.lost_before + sender.lost};
      continue;
    }
    const std::int64_t lost = out.received - sender.sent - (in->second.received - sender.received);
    if (lost > sender.lost) {
      sender.lost = lost;
      bus.set_lost(out.channel, sender.lost_before + lost);
      more.push_back(out.channel);
    }
  }
  return more;
}

}  // namespace modslam
