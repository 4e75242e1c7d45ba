// SPDX-License-Identifier: BSD-3-Clause
/// procs/scan_matcher — LASER + ODOMETRY + SENSOR_INFO → SCAN_MATCH. Config: [scan_matcher], [odometry_model].
#include <algorithm>
#include <deque>
#include <modslam/matcher_state_t.hpp>
#include <modslam/scan_match_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/journal.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/scan_source.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

constexpr std::int64_t kSilence_us = 1'000'000;
constexpr double kFar_m = 1.0, kFar_rad = 0.8;

class ScanMatcherModule : public Module {
 public:
  ScanMatcherModule(Bus& bus, const SystemConfig& config)
      : bus_(bus),
        matcher_config_(config.scan_matcher),
        odometry_model_(config.odometry_model),
        matcher_(config.scan_matcher, config.odometry_model),
        source_(bus, channel::kOdometry, [this](const Scan& scan, const Pose2& T_odom_base) { match(scan, T_odom_base); }),
        journal_(config.journal, bus.name()) {
    bus.publishes(channel::kScanMatch);
    resume();
  }

  void finish() override { source_.flush(); }

  std::string words() const override {
    return std::to_string(seq_) + " scans matched, " + std::to_string(doubtful_) + " doubtful, " +
           std::to_string(source_.without_odometry()) + " without odometry" +
           (breaks_ ? ", " + std::to_string(breaks_) + " new beginnings after a silence" : "") +
           (journal_.trouble().empty() ? "" : "; " + journal_.trouble());
  }
  std::optional<Resumption> resumption() const override { return resumption_; }

 private:
  /// Where the life before stood: its local map and its pose.
  void resume() {
    matcher_state_t state{}, newest{};
    bot_core::planar_lidar_t laser{};
    std::deque<ScanMatcher::PlacedScan> joined;  // no more than the local map holds
    bool joins = false;
    journal_.read_past([&](const LogEvent& record) {
      if (record.channel == channel::kLaser) {
        joins = read_record(record, laser);
      } else if (read_record(record, state)) {
        newest = state;
        if (joins) joined.push_back({to_scan(laser), to_sensor_info(state.sensor), to_pose(state.T_track_base)});
        while (joined.size() > std::max<std::size_t>(1, static_cast<std::size_t>(std::max(0, state.keyframes)))) joined.pop_front();
        joins = false;
      }
    });
    if (joined.empty()) return;
    matcher_.resume({joined.begin(), joined.end()}, to_pose(newest.T_track_base), newest.failures);
    source_.set_sensor(joined.back().sensor);
    T_odom_last_ = to_pose(newest.T_odom_base);
    utime_last_ = newest.utime;
    track_ = newest.track;
    seq_ = newest.seq + 1;
    begins_ = false;
    doubtful_ = newest.doubtful;
    resumption_ = Resumption{{channel::kLaser, channel::kOdometry, channel::kSensorInfo}, channel::kLaser, utime_last_, journal_.last_us()};
  }

  /// After the match was published: whoever is killed in between matches the scan again, with the same result.
  void remember(const Scan& scan, const ScanMatch& result, bool joined) {
    if (!journal_.on()) return;
    if (joined) journal_.write(channel::kLaser, to_message(scan));
    matcher_state_t state{};
    state.utime = scan.utime;
    state.track = track_;
    state.seq = seq_;
    state.doubtful = doubtful_;
    put(state.T_track_base, result.T_track_base);
    put(state.T_odom_base, T_odom_last_);
    state.failures = matcher_.failures();
    state.keyframes = static_cast<std::int32_t>(matcher_.keyframes());
    state.sensor = to_message(source_.sensor(), scan.utime);
    journal_.write("MATCHER_STATE", state);
  }

  /// After a long silence the robot may be anywhere near: a new local map begins, and odometry alone spans the break.
  bool too_far(const Scan& scan, const Pose2& T_odom_base) const {
    const Pose2 motion = between(T_odom_last_, T_odom_base);
    return scan.utime - utime_last_ > kSilence_us && (std::hypot(motion.x, motion.y) > kFar_m || std::abs(motion.heading) > kFar_rad);
  }

  void match(const Scan& scan, const Pose2& T_odom_base) {
    if (!begins_ && too_far(scan, T_odom_base)) {
      matcher_ = ScanMatcher(matcher_config_, odometry_model_);
      begins_ = true;
      ++breaks_;
    }
    if (begins_) track_ = utime_last_ = scan.utime;
    const Pose2 motion = begins_ ? Pose2() : between(T_odom_last_, T_odom_base);
    const std::int64_t joined_before = matcher_.joined();
    const ScanMatch result = matcher_.match(scan, source_.sensor(), motion);
    doubtful_ += !is_usable(result.verdict) && result.verdict != Verdict::kFirst;
    publish(scan, result);
    T_odom_last_ = T_odom_base;
    utime_last_ = scan.utime;
    remember(scan, result, matcher_.joined() > joined_before);
    ++seq_;
    begins_ = false;
  }

  void publish(const Scan& scan, const ScanMatch& result) {
    scan_match_t message{};
    message.utime = scan.utime;
    message.utime_from = utime_last_;
    message.seq = seq_;
    message.track = track_;
    put(message.T_track_base, result.T_track_base);
    put(message.T_from_to, result.T_from_to);
    put(message.information, result.information);
    put(message.covariance, result.covariance);
    message.verdict = static_cast<std::int8_t>(result.verdict);
    message.degenerate_rad = wrap_angle(result.figures.degenerate_rad - result.T_track_base.heading);
    message.overlap = result.figures.overlap;
    message.chi2 = result.figures.chi2;
    message.ambiguity = result.figures.ambiguity;
    message.free_violation = result.figures.free_violation;
    message.innovation = result.figures.innovation;
    message.npoints = result.figures.points;
    message.iterations = result.figures.iterations;
    bus_.publish(channel::kScanMatch, message);
  }

  Bus& bus_;
  ScanMatcherConfig matcher_config_;
  OdometryModelConfig odometry_model_;
  ScanMatcher matcher_;
  ScanSource source_;
  Journal journal_;
  std::optional<Resumption> resumption_;
  Pose2 T_odom_last_;
  std::int64_t utime_last_ = 0, seq_ = 0, track_ = 0, doubtful_ = 0, breaks_ = 0;
  bool begins_ = true;  ///< the next scan begins a track
};

}  // namespace

std::unique_ptr<Module> make_scan_matcher(Bus& bus, const SystemConfig& config) {
  return std::make_unique<ScanMatcherModule>(bus, config);
}

}  // namespace modslam
