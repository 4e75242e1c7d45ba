// SPDX-License-Identifier: BSD-3-Clause
/// @file Streams that every scan counts in are repaired: who speaks keeps copies for a while, who misses one holds back what is behind the
/// gap, asks with REPEAT_REQUEST and goes on in order. A message's place in its stream is its number where it has one (SCAN_MATCH, POSE); of
/// the others it is their time, and a gap shows as a step in time. A stream whose times step back cannot be put in order by them: for a while
/// after that it is passed on as it comes.
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <modslam/process_status_t.hpp>
#include <modslam/repeat_request_t.hpp>
#include <modslam/repeat_t.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace modslam {

/// Whether messages on this channel are kept and repeated.
bool is_repeated(const std::string& channel);

/// The speaker's side.
class KeptMessages {
 public:
  void keep(const std::string& channel, const void* bytes, int size);
  /// What to say on REPEAT; nothing when the same was asked a moment ago, since everybody heard the answer.
  std::vector<repeat_t> answer(const repeat_request_t& request, std::int64_t now_us);

 private:
  struct Copy {
    std::int64_t place;
    std::vector<std::uint8_t> bytes;
    std::int64_t said_us;  ///< when it was repeated
  };
  struct Answered {
    std::int64_t after = 0, before = 0, at_us = 0;
  };
  std::map<std::string, std::deque<Copy>> copies_;
  std::map<std::string, Answered> answered_;
};

/// The listener's side: stands between network and handlers.
class StreamRepair : public Bus::Gate {
 public:
  /// @param ask says a REPEAT_REQUEST
  StreamRepair(Bus& bus, std::function<void(const repeat_request_t&)> ask) : bus_(bus), ask_(std::move(ask)) { bus.set_gate(this); }
  ~StreamRepair() override { bus_.set_gate(nullptr); }
  StreamRepair(const StreamRepair&) = delete;
  StreamRepair& operator=(const StreamRepair&) = delete;

  bool take(const std::string& channel, const void* bytes, int size) override;
  void note(const std::string& channel, const void* bytes, int size) override;
  bool awaits(const std::string& channel) const override;
  void suspect(const std::string& channel) override;

  /// Who speaks on which channel: only of a process of ours copies can be asked for.
  void take(const process_status_t& status);
  void take(const repeat_t& repeat);
  /// Asks again, and gives up after a second: then what is missing is lost, and of a speaker that says nothing the newest is not asked for
  /// again before it is heard. What it said in such a silence is asked for as soon as it is heard. @param now_us of a steady clock
  void tick(std::int64_t now_us);
  /// Nothing is held back.
  bool idle() const;

 private:
  using Bytes = std::vector<std::uint8_t>;
  struct Seen {
    std::int64_t place;
    std::size_t hash;
    bool heard;   ///< over the network itself, not only repeated
    bool before;  ///< its numbers have begun anew since
  };
  struct Stream {
    bool kept = false;                ///< its speaker keeps copies
    bool mute = false;                ///< it left a question about its newest without an answer, and was not heard since
    std::int64_t last = -1;           ///< place of the last one that was passed on
    std::deque<std::int64_t> steps;   ///< between the last ones
    int as_they_come = 0;             ///< of so many of the next nothing is held back
    std::map<std::int64_t, Bytes> held;  ///< behind a gap
    std::map<std::int64_t, std::int64_t> previous;  ///< of held messages, as their speaker told
    std::deque<Seen> seen;            ///< the last ones
    std::int64_t blocked_us = 0, asked_us = 0;      ///< 0: not
    bool tail = false;                ///< the newest may be missing
    std::int64_t tail_us = 0;
  };
  bool is_known(const std::string& channel, Stream& stream, std::int64_t place, std::size_t hash);
  static bool has_seen(const Stream& stream, std::int64_t place);
  bool follows(const std::string& channel, const Stream& stream, std::int64_t place) const;
  bool lacks_mount(const std::string& channel) const;
  void step_back(const std::string& channel, Stream& stream);
  void advance(const std::string& channel, Stream& stream);
  void pass(const std::string& channel, Stream& stream);
  static void see(Stream& stream, std::int64_t place, std::size_t hash, bool heard);
  static void went_by(Stream& stream, std::int64_t place);
  void ask(const std::string& channel, Stream& stream, std::int64_t before);

  Bus& bus_;
  std::function<void(const repeat_request_t&)> ask_;
  std::map<std::string, Stream> streams_;
  std::int64_t now_us_ = 1;
};

}  // namespace modslam
