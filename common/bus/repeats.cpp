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
constexpr int kAsTheyCome = 200;
constexpr std::size_t kSteps = 15, kSeen = 500, kHeld = 2000;
constexpr double kLongStep = 1.6;                 // times the usual one
constexpr std::int64_t kStillToCome = std::numeric_limits<std::int64_t>::max();

/// Where the number stands in messages that have one; behind the type's fingerprint stands the time.
int number_at(const std::string& channel) {
  if (channel == channel::kScanMatch) return 24;  // utime, utime_from, seq
  return channel == channel::kPose ? 16 : 0;      // utime, seq
}

std::int64_t place_of(const std::string& channel, const void* bytes, int size) {
  const int at = std::max(8, number_at(channel));
  std::uint64_t value = 0;
  if (size < at + 8) return -1;
  for (int k = at; k < at + 8; ++k) value = value << 8 | static_cast<const unsigned char*>(bytes)[k];
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
  const std::int64_t place = place_of(channel, bytes, size);
  if (number_at(channel) && !copies.empty() && place <= copies.back().place) copies.clear();  // numbers begin anew
  std::vector<std::uint8_t> place_in_memory;  // of the oldest: small pieces that live long, strewn over the heap, would hold its pages
  if (copies.size() == kCopies) {
    place_in_memory = std::move(copies.front().bytes);
    copies.pop_front();
  }
  const auto* first = static_cast<const std::uint8_t*>(bytes);
  place_in_memory.assign(first, first + size);
  copies.push_back({place, std::move(place_in_memory), -kSameQuestion_us});
}

std::vector<repeat_t> KeptMessages::answer(const repeat_request_t& request, std::int64_t now_us) {
  std::vector<repeat_t> answers;
  const auto kept = copies_.find(request.channel);
  if (kept == copies_.end()) return answers;
  Answered& answered = answered_[request.channel];
  if (answered.after == request.after && answered.before == request.before && now_us - answered.at_us < kSameQuestion_us)
    return answers;
  answered = {request.after, request.before, now_us};
  repeat_t message{};
  message.channel = request.channel;
  message.previous = -1;
  for (Copy& copy : kept->second) {
    message.place = copy.place;
    bool wanted = copy.place > request.after && copy.place < request.before;
    if (wanted && now_us - copy.said_us < kSameQuestion_us) wanted = false;  // to somebody else, for all to hear
    if (wanted) copy.said_us = now_us;
    message.data = wanted ? copy.bytes : std::vector<std::uint8_t>();
    message.nbytes = static_cast<std::int32_t>(message.data.size());
    if (wanted || copy.place == request.before) answers.push_back(message);
    if (answers.size() > kCopiesAnswered) return answers;
    message.previous = copy.place;
  }
  if (request.before == kStillToCome) {
    message.place = kStillToCome;
    message.nbytes = 0;
    message.data.clear();
    answers.push_back(message);
  }
  return answers;
}

/// Whether it came before: doubled by the network, which does not count, or repeated and now heard itself.
bool StreamRepair::is_known(const std::string& channel, Stream& stream, std::int64_t place, std::size_t hash) {
  const auto same = [&](const Seen& one) { return one.place == place && one.hash == hash; };
  const auto seen = std::find_if(stream.seen.rbegin(), stream.seen.rend(), same);
  if (seen == stream.seen.rend()) return false;
  if (seen->heard) bus_.uncount(channel);
  seen->heard = true;
  return true;
}

bool StreamRepair::has_seen(const Stream& stream, std::int64_t place) {
  return std::any_of(stream.seen.rbegin(), stream.seen.rend(), [place](const Seen& one) { return one.place == place && !one.before; });
}

bool StreamRepair::take(const std::string& channel, const void* bytes, int size) {
  if (!is_repeated(channel)) return false;
  Stream& stream = streams_[channel];
  stream.mute = false;
  const std::int64_t place = place_of(channel, bytes, size);
  const std::size_t hash = hash_of(bytes, size);
  if (stream.kept && is_known(channel, stream, place, hash)) return true;
  see(stream, place, hash, true);
  if (stream.kept && place <= stream.last) step_back(channel, stream);
  const bool as_it_comes = !stream.kept || stream.as_they_come > 0;
  while (as_it_comes && !stream.held.empty()) pass(channel, stream);  // never overtaken
  if (as_it_comes || (stream.held.empty() && follows(channel, stream, place))) {
    stream.as_they_come = std::max(0, stream.as_they_come - 1);
    went_by(stream, place);
    return false;
  }
  stream.held.emplace(place, copy(bytes, size));
  advance(channel, stream);
  return true;
}

/// What waited came before the one that steps back. A number falls when its speaker begins anew, a time in some logs again and again.
void StreamRepair::step_back(const std::string& channel, Stream& stream) {
  while (!stream.held.empty()) pass(channel, stream);
  stream.as_they_come = number_at(channel) ? 1 : kAsTheyCome;
  if (!number_at(channel)) return;
  for (Seen& one : stream.seen) one.before = true;  // their numbers come anew; they themselves, doubled by the network, must not
  stream.seen.back().before = false;
  stream.previous.clear();
}

void StreamRepair::note(const std::string& channel, const void* bytes, int size) {
  if (!is_repeated(channel)) return;
  see(streams_[channel], place_of(channel, bytes, size), hash_of(bytes, size), false);
  went_by(streams_[channel], place_of(channel, bytes, size));
}

bool StreamRepair::awaits(const std::string& channel) const {
  const auto stream = streams_.find(channel);
  return stream != streams_.end() && stream->second.kept && (stream->second.blocked_us != 0 || stream->second.tail);
}

void StreamRepair::suspect(const std::string& channel) {
  const auto found = streams_.find(channel);
  if (found == streams_.end() || !found->second.kept || found->second.mute || found->second.tail) return;
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
    stream.mute = false;
    if (news && out.channel == channel::kSensorInfo && stream.last < 0) suspect(out.channel);
  }
}

void StreamRepair::take(const repeat_t& repeat) {
  const auto found = streams_.find(repeat.channel);
  if (found == streams_.end() || !is_repeated(repeat.channel)) return;
  Stream& stream = found->second;
  if (repeat.place == kStillToCome) {
    if (repeat.previous <= stream.last) stream.tail = false;
    return;
  }
  if (repeat.place <= stream.last || (stream.last < 0 && !stream.tail)) return;
  stream.previous[repeat.place] = repeat.previous;
  const std::size_t hash = hash_of(repeat.data.data(), repeat.nbytes);
  const auto same = [&](const Seen& one) { return one.place == repeat.place && one.hash == hash; };  // also before its numbers began anew
  if (repeat.nbytes > 0 && !has_seen(stream, repeat.place) && std::none_of(stream.seen.begin(), stream.seen.end(), same)) {
    see(stream, repeat.place, hash, false);
    stream.held.emplace(repeat.place, repeat.data);
  }
  advance(repeat.channel, stream);
}

/// Whether nothing is missing between what was passed on and `place`.
bool StreamRepair::follows(const std::string& channel, const Stream& stream, std::int64_t place) const {
  if (lacks_mount(channel)) return false;
  if (stream.last < 0) return true;
  if (number_at(channel) && place == stream.last + 1) return true;
  const auto told = stream.previous.find(place);
  if (told != stream.previous.end()) return told->second <= stream.last || has_seen(stream, told->second);
  if (number_at(channel) || stream.steps.size() < 3) return false;
  std::vector<std::int64_t> steps(stream.steps.begin(), stream.steps.end());
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return static_cast<double>(place - stream.last) <= kLongStep * static_cast<double>(steps[steps.size() / 2]);
}

/// A scan means nothing before it is known where the laser sits.
bool StreamRepair::lacks_mount(const std::string& channel) const {
  if (channel != channel::kLaser) return false;
  const auto mount = streams_.find(channel::kSensorInfo);
  return mount != streams_.end() && mount->second.kept && mount->second.last < 0;
}

void StreamRepair::advance(const std::string& channel, Stream& stream) {
  while (!stream.held.empty() && follows(channel, stream, stream.held.begin()->first)) pass(channel, stream);
  if (stream.held.empty()) {
    stream.blocked_us = stream.asked_us = 0;
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
  stream.blocked_us = 0;
  if (stream.asked_us != 0) stream.asked_us = now_us_;  // the rest of the answer is on its way: patience
  bus_.pass_on(channel, bytes.data(), static_cast<int>(bytes.size()));
  if (channel == channel::kSensorInfo) advance(channel::kLaser, streams_[channel::kLaser]);
}

void StreamRepair::see(Stream& stream, std::int64_t place, std::size_t hash, bool heard) {
  stream.seen.push_back({place, hash, heard, false});
  if (stream.seen.size() > kSeen) stream.seen.pop_front();
}

void StreamRepair::went_by(Stream& stream, std::int64_t place) {
  if (stream.last >= 0 && place > stream.last) {
    stream.steps.push_back(place - stream.last);
    if (stream.steps.size() > kSteps) stream.steps.pop_front();
  }
  stream.last = place;
}

void StreamRepair::ask(const std::string& channel, Stream& stream, std::int64_t before) {
  stream.asked_us = now_us_;
  repeat_request_t request{};
  request.utime = bus_.utime();
  request.requester = bus_.name();
  request.channel = channel;
  request.after = stream.last;
  request.before = before;
  ask_(request);
  if (lacks_mount(channel)) suspect(channel::kSensorInfo);
}

void StreamRepair::tick(std::int64_t now_us) {
  now_us_ = now_us;
  for (auto& [channel, stream] : streams_) {
    if (stream.tail && now_us - stream.tail_us > kPatience_us) {
      stream.tail = false;
      stream.mute = true;  // it still keeps copies: after a cut cable its next message shows a gap
    }
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
