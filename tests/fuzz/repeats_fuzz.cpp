// SPDX-License-Identifier: BSD-3-Clause
/// A speaker, a listener, and a network that does to their messages what the bytes say: lose, double, reorder, invent.
/// Whatever it is: nothing is handled twice, nothing that the speaker did not say but for the invented, and nothing is held back for ever.
#include <bot_core/pose_t.hpp>
#include <cstdlib>
#include <modslam/scan_match_t.hpp>
#include <set>
#include <utility>

#include "common/bus/repeats.hpp"

using namespace modslam;

namespace {

constexpr std::int64_t kStep_us = 50'000;

class Pair {
 public:
  Pair() {
    bus_.subscribe<scan_match_t>("SCAN_MATCH", [this](const scan_match_t& m) {
      if (!handled_.insert(m.seq).second) std::abort();
    });
    bus_.subscribe<bot_core::pose_t>("ODOMETRY", [](const bot_core::pose_t&) {});
    process_status_t status{};
    for (const char* channel : {"SCAN_MATCH", "ODOMETRY"}) {
      channel_count_t out{};
      out.channel = channel;
      status.outputs.push_back(out);
    }
    status.noutputs = static_cast<std::int32_t>(status.outputs.size());
    repair_.take(status);
  }

  void say(bool arrives) {
    scan_match_t match{};
    match.utime = ++said_ * kStep_us;
    match.seq = said_;
    hand_over("SCAN_MATCH", match, arrives);
  }
  void say_pose(std::int64_t utime, bool arrives) {
    bot_core::pose_t pose{};
    pose.utime = utime;
    hand_over("ODOMETRY", pose, arrives);
  }
  void repeat_late(std::size_t which) {
    if (!letters_.empty()) arrive(letters_[which % letters_.size()]);
  }
  void answer(bool lost) {
    for (const repeat_request_t& question : std::exchange(asked_, {}))
      for (const repeat_t& one : kept_.answer(question, now_us_))
        if (!lost) repair_.take(one);
  }
  void ask(std::int64_t after, std::int64_t before) {
    repeat_request_t question{};
    question.channel = "ODOMETRY";
    question.after = after;
    question.before = before;
    asked_.push_back(question);
  }
  void invent(std::int64_t place, std::int64_t previous) {
    repeat_t one{};
    one.channel = "ODOMETRY";
    one.place = place;
    one.previous = previous;
    one.data.assign(one.nbytes = static_cast<std::int32_t>(place & 31), 7);
    repair_.take(one);
  }
  void suspect() { repair_.suspect("ODOMETRY"); }
  void wait() { repair_.tick(now_us_ += 30'000); }
  void end() {
    for (int k = 0; k < 3000 && !repair_.idle(); ++k) wait();
    if (!repair_.idle()) std::abort();
  }

 private:
  struct Letter {
    const char* channel;
    std::vector<std::uint8_t> bytes;
  };
  template <class Message>
  void hand_over(const char* channel, const Message& message, bool arrives) {
    Letter letter{channel, std::vector<std::uint8_t>(static_cast<std::size_t>(message.getEncodedSize()))};
    message.encode(letter.bytes.data(), 0, static_cast<int>(letter.bytes.size()));
    kept_.keep(channel, letter.bytes.data(), static_cast<int>(letter.bytes.size()));
    if (arrives) arrive(letter);
    letters_.push_back(std::move(letter));
  }
  void arrive(const Letter& letter) {
    transport_.publish(letter.channel, letter.bytes.data(), static_cast<int>(letter.bytes.size()));
    while (transport_.poll(0)) {
    }
  }

  Transport transport_{"memq://"};
  Bus bus_{transport_, "listener"};
  std::vector<repeat_request_t> asked_;
  StreamRepair repair_{bus_, [this](const repeat_request_t& m) { asked_.push_back(m); }};
  KeptMessages kept_;
  std::vector<Letter> letters_;
  std::set<std::int64_t> handled_;
  std::int64_t said_ = 0, now_us_ = 1;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Pair pair;
  std::int64_t utime = 0;
  for (std::size_t k = 0; k + 1 < size; k += 2) {
    const std::uint8_t what = data[k] % 10, how = data[k + 1];
    if (what < 3) pair.say(how % 3 != 0);
    if (what == 3) pair.say_pose(utime += kStep_us * (static_cast<std::int8_t>(how) / 8), how % 2 == 0);
    if (what == 4) pair.repeat_late(how);
    if (what == 5) pair.answer(how % 4 == 0);
    if (what == 6) pair.wait();
    if (what == 7) pair.suspect();
    if (what == 8) pair.ask(how, how * kStep_us);
    if (what == 9) pair.invent(utime + how - 128, how * kStep_us);
  }
  pair.end();
  return 0;
}
