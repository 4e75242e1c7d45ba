// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/history.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace modslam {
namespace {

constexpr std::int64_t kLongestInterval_us = std::int64_t{3600} * 1'000'000;
constexpr std::size_t kRoomShare = 8;  // of the arena that is made free at once, so that gaps are closed seldom

/// Text gets five times smaller; tiles are packed already and stay as they are.
std::string pack(const Frame& frame) {
  if (frame.binary) return frame.bytes;
  uLongf size = compressBound(static_cast<uLong>(frame.bytes.size()));
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(frame.bytes.data()),
                static_cast<uLong>(frame.bytes.size()), Z_BEST_SPEED) != Z_OK)
    throw std::bad_alloc();  // all else would be a wrong size
  packed.resize(size);
  return packed;
}

}  // namespace

History::Record History::record(std::size_t offset) const {
  Record found;
  std::memcpy(&found, &arena_[offset], sizeof found);
  return found;
}

FramePtr History::frame(std::size_t offset) const {
  const Record found = record(offset);
  const char* const packed = &arena_[offset] + sizeof found;
  if (found.binary) return std::make_shared<Frame>(Frame{true, {packed, found.packed_size}});
  std::string bytes(found.size, '\0');
  uLongf size = found.size;
  uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(packed), found.packed_size);
  return std::make_shared<Frame>(Frame{false, std::move(bytes)});
}

void History::kill(std::size_t offset) {
  Record dead = record(offset);
  dead.alive = false;
  std::memcpy(&arena_[offset], &dead, sizeof dead);
  extent_.bytes -= sizeof dead + dead.packed_size;
}

void History::add(const std::string& stream, std::int64_t utime, const FramePtr& frame) {
  const std::string packed = pack(*frame);
  const std::lock_guard lock(mutex_);
  if (extent_.begin_utime == 0) extent_.begin_utime = utime;  // 0: before the run had a time
  extent_.end_utime = std::max(extent_.end_utime, utime);
  const auto [place, is_new] = streams_.try_emplace(stream);
  Stream& known = place->second;
  if (is_new) known.number = static_cast<std::uint32_t>(streams_.size() - 1);
  if (known.newest != kNone && record(known.newest).utime / extent_.interval_us == extent_.end_utime / extent_.interval_us) {
    kill(known.newest);
    known.newest = kNone;
  }
  const Record made{extent_.end_utime, known.number, static_cast<std::uint32_t>(packed.size()),
                    static_cast<std::uint32_t>(frame->bytes.size()), frame->binary, true};
  const std::size_t needed = sizeof made + packed.size();
  if (!make_room(needed)) return;
  known.newest = end_;
  std::memcpy(&arena_[end_], &made, sizeof made);
  std::copy(packed.begin(), packed.end(), arena_.begin() + static_cast<std::ptrdiff_t>(end_ + sizeof made));
  end_ += needed;
  extent_.bytes += needed;
}

/// @return whether there are so many free bytes behind the last record.
bool History::make_room(std::size_t bytes) {
  if (end_ + bytes <= arena_.size()) return true;
  const std::size_t wanted = std::max(bytes, arena_.size() / kRoomShare);
  while (extent_.bytes + wanted > arena_.size() && extent_.interval_us < kLongestInterval_us) {
    extent_.interval_us *= 2;
    drop_all_but_last_of_interval();
  }
  close_gaps();
  return end_ + bytes <= arena_.size();
}

void History::drop_all_but_last_of_interval() {
  std::vector<std::size_t> last(streams_.size(), kNone);
  for (std::size_t offset = 0; offset < end_;) {
    const Record here = record(offset);
    if (here.alive) {
      std::size_t& before = last[here.stream];
      if (before != kNone && record(before).utime / extent_.interval_us == here.utime / extent_.interval_us) kill(before);
      before = offset;
    }
    offset += sizeof here + here.packed_size;
  }
}

void History::close_gaps() {
  std::vector<std::size_t> newest(streams_.size(), kNone);
  std::size_t to = 0;
  for (std::size_t from = 0; from < end_;) {
    const Record here = record(from);
    const std::size_t size = sizeof here + here.packed_size;
    if (here.alive) {
      std::memmove(&arena_[to], &arena_[from], size);
      newest[here.stream] = to;
      to += size;
    }
    from += size;
  }
  end_ = to;
  for (auto& [name, stream] : streams_) stream.newest = newest[stream.number];
}

void History::clear() {
  const std::lock_guard lock(mutex_);
  streams_.clear();
  extent_ = {};
  end_ = 0;
}

std::vector<FramePtr> History::at(std::int64_t utime) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::size_t> shown(streams_.size(), kNone);
  for (std::size_t offset = 0; offset < end_;) {
    const Record here = record(offset);
    if (here.utime > utime) break;
    if (here.alive) shown[here.stream] = offset;
    offset += sizeof here + here.packed_size;
  }
  std::vector<FramePtr> frames;
  for (const auto& [name, stream] : streams_)
    if (shown[stream.number] != kNone) frames.push_back(frame(shown[stream.number]));
  return frames;
}

History::Extent History::extent() const {
  const std::lock_guard lock(mutex_);
  return extent_;
}

}  // namespace modslam
