// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/loss_meter.hpp"

#include <algorithm>

#include "common/bus/channels.hpp"

namespace modslam {
namespace {

bool has_many_speakers(const std::string& name) {
  return name == channel::kStatus || name == channel::kParameters || name == channel::kCommand || name == channel::kSyncRequest ||
         name == channel::kRepeat || name == channel::kRepeatRequest;
}

}  // namespace

/// Everybody speaks on STATUS, but each says who he is.
void LossMeter::take_statuses(const process_status_t& status, Bus& bus) {
  Sender& sender = statuses_[status.name];
  for (const channel_count_t& out : status.outputs) {
    if (out.channel != channel::kStatus) continue;  // counts those before this one
    if (sender.pid == status.pid && out.received == sender.newest) return;  // the network doubled it
    ++sender.received;
    sender.newest = out.received;
    if (sender.pid != status.pid) sender = {status.pid, out.received, 0, 0, sender.lost_before + sender.lost, out.received};
    sender.lost = std::max(sender.lost, out.received - sender.sent - sender.received);
  }
  if (!bus.inputs().count(channel::kStatus)) return;
  std::int64_t lost = 0;
  for (const auto& [name, one] : statuses_) lost += one.lost_before + one.lost;
  bus.set_lost(channel::kStatus, lost);
}

std::vector<std::string> LossMeter::take(const process_status_t& status, Bus& bus) {
  take_statuses(status, bus);
  const Sender& speaker = statuses_[status.name];
  const bool was_heard = speaker.pid == status.pid && speaker.received > 0;
  std::vector<std::string> more;
  for (const channel_count_t& out : status.outputs) {
    if (has_many_speakers(out.channel) || !bus.hears(out.channel)) continue;
    const auto in = bus.inputs().find(out.channel);
    const std::int64_t received = in == bus.inputs().end() ? 0 : in->second.received;
    // Who spoke before he said anything here had said nothing then: the STATUS that told of his first messages may be lost as they are.
    const bool from_its_beginning = !by_channel_.count(out.channel) && was_heard;
    Sender& sender = by_channel_[out.channel];
    if (from_its_beginning) sender.pid = status.pid;
    if (sender.pid != status.pid || out.received < sender.sent) {
      sender = {status.pid, out.received, received, 0, sender.lost_before + sender.lost, 0};
      continue;
    }
    const std::int64_t lost = out.received - sender.sent - (received - sender.received);
    if (lost > sender.lost) more.push_back(out.channel);
    sender.lost = std::max<std::int64_t>(lost, 0);  // fewer when a STATUS had overtaken what came before it
    bus.set_lost(out.channel, sender.lost_before + sender.lost);
  }
  return more;
}

}  // namespace modslam
