// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/repeats.hpp"

#include <algorithm>
#include <limits>
#include <string_view>

#include "common/bus/channels.hpp"

namespace modslam {
namespace {

constexpr std::size_t kCopies = 1000;             // of a channel: eight seconds of the fastest
constexpr std::size_t kCopiesAnswered = 100;      // at once; whoever lacks more asks again
constexpr std::int64_t kSameQuestion_us = 15'000;
constexpr std::int64_t kAskAgain_us = 40'000, kPatience_us = 1'000'000;
constexpr std::size_t kSteps = 15, kSeen = 500, kHeld = 2000;
constexpr double kLongStep = 1.6;                 // times the usual one
constexpr std::int64_t kStillToCome = std::numeric_limits<std::int64_t>::max();

/// Behind the type's fingerprint stands the time.
std::int64_t utime_of(const void* bytes, int size) {
  std::uint64_t value = 0;
  if (size < 16) return -1;
  for (int k = 8; k < 16; ++k) value = value << 8 | static_cast<const unsigned char*>(bytes)[k];
  return static_cast<std::int64_t>(value);
}

std::vector<std::uint8_t> copy(const void* bytes, int size) {
  const auto* first = static_cast<const std::uint8_t*>(bytes);
  return {first, first + size};
}

std::size_t hash_of(const void* bytes, int size) {
  return std::hash<std::string_view>()({static_cast<const char*>(bytes), static_cast<std::size_t>(size)});
}

}  // namespace

bool is_repeated(const std::string& channel) {
  static const std::set<std::string> all{channel::kLaser, channel::kSensorInfo,  channel::kOdometry, channel::kIns,
                                         channel::kPose,  channel::kGroundTruth, channel::kScanMatch};
  return all.count(channel) > 0;
}

void KeptMessages::keep(const std::string& channel, const void* bytes, int size) {
  if (!is_repeated(channel)) return;
  std::deque<Copy>& copies = copies_[channel];
  copies.push_back({utime_of(bytes, size), copy(bytes, size)});
  if (copies.size() > kCopies) copies.pop_front();
}

std::vector<repeat_t> KeptMessages::answer(const repeat_request_t& request, std::int64_t now_us) {
  std::vector<repeat_t> answers;
  const auto kept = copies_.find(request.channel);
  if (kept == copies_.end()) return answers;
  Answered& answered = answered_[request.channel];
  if (answered.after_utime == request.after_utime && answered.before_utime == request.before_utime && now_us - answered.at_us < kSameQuestion_us)
    return answers;
  answered = {request.after_utime, request.before_utime, now_us};
  repeat_t message{};
  message.channel = request.channel;
  message.previous_utime = -1;
  for (const Copy& copy : kept->second) {
    message.utime = copy.utime;
    const bool wanted = copy.utime > request.after_utime && copy.utime < request.before_utime;
    message.data = wanted ? copy.bytes : std::vector<std::uint8_t>();
    message.nbytes = static_cast<std::int32_t>(message.data.size());
    if (wanted || copy.utime == request.before_utime) answers.push_back(message);
    if (answers.size() > kCopiesAnswered) return answers;
    message.previous_utime = copy.utime;
  }
  if (request.before_utime == kStillToCome) {
    message.utime = kStillToCome;
    message.nbytes = 0;
    message.data.clear();
    answers.push_back(message);
  }
  return answers;
}

/// Whether it came before: doubled by the network, which does not count, or repeated and now heard itself.
bool StreamRepair::is_known(const std::string& channel, Stream& stream, std::int64_t utime, std::size_t hash) {
  const auto same = [&](const Seen& one) { return one.utime == utime && one.hash == hash; };
  const auto seen = std::find_if(stream.seen.rbegin(), stream.seen.rend(), same);
  if (seen == stream.seen.rend()) return false;
  if (seen->heard) bus_.uncount(channel);
  seen->heard = true;
  return true;
}

bool StreamRepair::has_seen(const Stream& stream, std::int64_t utime) {
  return std::any_of(stream.seen.rbegin(), stream.seen.rend(), [utime](const Seen& one) { return one.utime == utime; });
}

bool StreamRepair::take(const std::string& channel, const void* bytes, int size) {
  if (!is_repeated(channel)) return false;
  Stream& stream = streams_[channel];
  const std::int64_t utime = utime_of(bytes, size);
  const std::size_t hash = hash_of(bytes, size);
  if (stream.kept && is_known(channel, stream, utime, hash)) return true;
  see(stream, utime, hash, true);
  if (utime <= stream.last_utime)
    while (!stream.held.empty()) pass(channel, stream);  // stamps step back: what waited came before this one
  // Nobody to ask; or stamps that step back, as some logs have them.
  if (!stream.kept || utime <= stream.last_utime || (stream.held.empty() && follows(channel, stream, utime))) {
    went_by(stream, utime);
    return false;
  }
  stream.held.emplace(utime, copy(bytes, size));
  advance(channel, stream);
  return true;
}

void StreamRepair::note(const std::string& channel, const void* bytes, int size) {
  if (!is_repeated(channel)) return;
  see(streams_[channel], utime_of(bytes, size), hash_of(bytes, size), false);
  went_by(streams_[channel], utime_of(bytes, size));
}

bool StreamRepair::awaits(const std::string& channel) const {
  const auto stream = streams_.find(channel);
  return stream != streams_.end() && stream->second.kept && (stream->second.blocked_us != 0 || stream->second.tail);
}

void StreamRepair::suspect(const std::string& channel) {
  const auto found = streams_.find(channel);
  if (found == streams_.end() || !found->second.kept || found->second.tail) return;
  found->second.tail = true;
  found->second.tail_us = now_us_;
  ask(channel, found->second, kStillToCome);
}

void StreamRepair::take(const process_status_t& status) {
  for (const channel_count_t& out : status.outputs) {
    if (!is_repeated(out.channel)) continue;
    Stream& stream = streams_[out.channel];
    const bool news = !stream.kept;
    stream.kept = true;
    if (news && out.channel == channel::kSensorInfo && stream.last_utime < 0) suspect(out.channel);
  }
}

void StreamRepair::take(const repeat_t& repeat) {
  const auto found = streams_.find(repeat.channel);
  if (found == streams_.end() || !is_repeated(repeat.channel)) return;
  Stream& stream = found->second;
  if (repeat.utime == kStillToCome) {
    if (repeat.previous_utime <= stream.last_utime) stream.tail = false;
    return;
  }
  if (repeat.utime <= stream.last_utime || (stream.last_utime < 0 && !stream.tail)) return;
  stream.previous[repeat.utime] = repeat.previous_utime;
  if (repeat.nbytes > 0 && !has_seen(stream, repeat.utime)) {
    see(stream, repeat.utime, hash_of(repeat.data.data(), repeat.nbytes), false);
    stream.held.emplace(repeat.utime, repeat.data);
  }
  advance(repeat.channel, stream);
}

/// Whether nothing is missing between what was passed on and `utime`.
bool StreamRepair::follows(const std::string& channel, const Stream& stream, std::int64_t utime) const {
  if (lacks_mount(channel)) return false;
  if (stream.last_utime < 0) return true;
  const auto told = stream.previous.find(utime);
  if (told != stream.previous.end()) return told->second <= stream.last_utime || has_seen(stream, told->second);
  if (stream.steps_us.size() < 3) return false;
  std::vector<std::int64_t> steps(stream.steps_us.begin(), stream.steps_us.end());
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return static_cast<double>(utime - stream.last_utime) <= kLongStep * static_cast<double>(steps[steps.size() / 2]);
}

/// A scan means nothing before it is known where the laser sits.
bool StreamRepair::lacks_mount(const std::string& channel) const {
  if (channel != channel::kLaser) return false;
  const auto mount = streams_.find(channel::kSensorInfo);
  return mount != streams_.end() && mount->second.kept && mount->second.last_utime < 0;
}

void StreamRepair::advance(const std::string& channel, Stream& stream) {
  while (!stream.held.empty() && follows(channel, stream, stream.held.begin()->first)) pass(channel, stream);
  if (stream.held.empty()) {
    stream.blocked_us = 0;
    stream.previous.clear();
    return;
  }
  if (stream.blocked_us == 0) stream.blocked_us = now_us_;
  if (stream.asked_us == 0) ask(channel, stream, stream.held.begin()->first);
}

void StreamRepair::pass(const std::string& channel, Stream& stream) {
  const auto first = stream.held.begin();
  const Bytes bytes = std::move(first->second);
  went_by(stream, first->first);
  stream.held.erase(first);
  stream.blocked_us = stream.asked_us = 0;
  bus_.pass_on(channel, bytes.data(), static_cast<int>(bytes.size()));
  if (channel == channel::kSensorInfo) advance(channel::kLaser, streams_[channel::kLaser]);
}

void StreamRepair::see(Stream& stream, std::int64_t utime, std::size_t hash, bool heard) {
  stream.seen.push_back({utime, hash, heard});
  if (stream.seen.size() > kSeen) stream.seen.pop_front();
}

void StreamRepair::went_by(Stream& stream, std::int64_t utime) {
  if (stream.last_utime >= 0 && utime > stream.last_utime) {
    stream.steps_us.push_back(utime - stream.last_utime);
    if (stream.steps_us.size() > kSteps) stream.steps_us.pop_front();
  }
  stream.last_utime = utime;
}

void StreamRepair::ask(const std::string& channel, Stream& stream, std::int64_t before_utime) {
  stream.asked_us = now_us_;
  repeat_request_t request{};
  request.utime = bus_.utime();
  request.requester = bus_.name();
  request.channel = channel;
  request.after_utime = stream.last_utime;
  request.before_utime = before_utime;
  ask_(request);
  if (lacks_mount(channel)) suspect(channel::kSensorInfo);
}

void StreamRepair::tick(std::int64_t now_us) {
  now_us_ = now_us;
  for (auto& [channel, stream] : streams_) {
    if (stream.tail && now_us - stream.tail_us > kPatience_us) stream.tail = stream.kept = false;  // until its speaker is heard again
    if (stream.held.empty()) {
      if (stream.tail && now_us - stream.asked_us > kAskAgain_us) ask(channel, stream, kStillToCome);
      continue;
    }
    if (now_us - stream.blocked_us > kPatience_us || stream.held.size() > kHeld) {
      bus_.count_gap(channel, 1);
      pass(channel, stream);  // what is missing stays lost
      advance(channel, stream);
    } else if (now_us - stream.asked_us > kAskAgain_us) {
      ask(channel, stream, stream.held.begin()->first);
    }
  }
}

bool StreamRepair::idle() const {
  return std::all_of(streams_.begin(), streams_.end(), [](const auto& entry) { return entry.second.held.empty() && !entry.second.tail; });
}

}  // namespace modslam
