// SPDX-License-Identifier: BSD-3-Clause
/// procs/player — a log's sensor channels on the bus, and PLAYBACK; PLAYBACK_COMMAND in: play, pause, step, speed N.
/// Config: [player]. Unlike the stock player it can wait, and after a wait it goes on at the old pace: nothing is sent in a burst.
#include <algorithm>
#include <cstdlib>
#include <modslam/command_t.hpp>
#include <modslam/playback_t.hpp>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

constexpr std::int64_t kTellEvery_us = 200'000;
constexpr int kMostATick = 100;  // a tick is some milliseconds: who lags catches up without a flood

class PlayerModule : public Module {
 public:
  PlayerModule(Bus& bus, const PlayerConfig& config) : bus_(bus), speed_(config.speed), paused_(config.paused) {
    LogReader reader(config.log);
    LogEvent event;
    while (reader.next(event))
      if (std::count(std::begin(channel::from_logs), std::end(channel::from_logs), event.channel)) events_.push_back(event);
    if (events_.empty()) throw std::runtime_error(config.log + ": holds nothing that can be played");
    bus.subscribe<command_t>(channel::kPlaybackCommand, [this](const command_t& m) { obey(m.verb); });
  }

  void tick(std::int64_t steady_us) override {
    now_us_ = steady_us;
    if (anchor_us_ == 0) anchor();
    int sent = 0;
    while (!paused_ && !ended() && due_us() <= now_us_ && sent++ < kMostATick) send_next();
    if (now_us_ - told_us_ >= kTellEvery_us || changed_) tell();
  }

  bool ended() const override { return next_ == events_.size(); }
  std::string words() const override {
    char text[100];
    std::snprintf(text, sizeof text, "%s, %.1f of %.1f s, %g times real time",
                  ended() ? "at the end" : paused_ ? "paused" : "playing", position_s(), length_s(), speed_);
    return text;
  }

 private:
  void obey(const std::string& verb) {
    if (verb == "play") {
      paused_ = false;
    } else if (verb == "pause") {
      paused_ = true;
    } else if (verb == "step") {
      paused_ = true;
      while (!ended() && send_next() != channel::kLaser) {
      }
    } else if (verb.rfind("speed ", 0) == 0) {
      const double speed = std::atof(verb.c_str() + 6);
      if (!(speed >= 0.1 && speed <= 20)) throw BadMessage("speed " + verb.substr(6) + " is not within 0.1 and 20");
      speed_ = speed;
    } else {
      throw BadMessage("unknown verb '" + verb + "'");
    }
    anchor();
    changed_ = true;
  }

  /// From here on the log runs at speed_ again.
  void anchor() {
    anchor_us_ = now_us_;
    anchor_log_us_ = next_ == 0 ? events_[0].utime : events_[next_ - 1].utime;
  }
  std::int64_t due_us() const {
    return anchor_us_ + static_cast<std::int64_t>(static_cast<double>(events_[next_].utime - anchor_log_us_) / speed_);
  }

  const std::string& send_next() {
    const LogEvent& event = events_[next_++];
    bus_.publish_bytes(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    changed_ = changed_ || ended();
    return event.channel;
  }

  double position_s() const {
    return next_ == 0 ? 0.0 : static_cast<double>(events_[next_ - 1].utime - events_[0].utime) * 1e-6;
  }
  double length_s() const { return static_cast<double>(events_.back().utime - events_[0].utime) * 1e-6; }

  void tell() {
    told_us_ = now_us_;
    changed_ = false;
    playback_t m{};
    m.utime = next_ == 0 ? 0 : events_[next_ - 1].utime;
    m.position_s = position_s();
    m.length_s = length_s();
    m.speed = speed_;
    m.paused = paused_;
    m.ended = ended();
    bus_.publish(channel::kPlayback, m);
  }

  Bus& bus_;
  std::vector<LogEvent> events_;
  std::size_t next_ = 0;
  double speed_;
  bool paused_, changed_ = true;
  std::int64_t now_us_ = 0, anchor_us_ = 0, anchor_log_us_ = 0, told_us_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_player(Bus& bus, const SystemConfig& config) {
  return std::make_unique<PlayerModule>(bus, config.player);
}

}  // namespace modslam
