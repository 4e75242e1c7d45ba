// SPDX-License-Identifier: BSD-3-Clause
/// procs/localizer — SCAN_MATCH + LASER + SENSOR_INFO (+ SYNC_REQUEST) → POSE, NODE, GRAPH of a saved map that it only reads.
/// Config: [launch] map, [scan_matcher] (range noise and limit).
/// Starts without a pose: looks for the robot in the whole map, says nothing until only one place is left, then matches every scan against the map.
#include <Eigen/Cholesky>
#include <algorithm>
#include <deque>
#include <modslam/scan_match_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/estimator_session.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/system_config.hpp"
#include "common/loops/relocalizer.hpp"

namespace modslam {
namespace {

constexpr std::size_t kScansKept = 10'000;  // that wait for their match
constexpr double kTrack_m = 0.01, kTrack_rad = 0.005;  // how far the matcher's track errs from one scan to the next
constexpr double kFarStep_m = 0.3;                     // a match that jumps farther is none
constexpr int kFailuresBeforeLost = 30;     // scans in a row that fit nowhere near: looks in the whole map again

class LocalizerModule : public Module {
 public:
  LocalizerModule(Bus& bus, const SystemConfig& config)
      : bus_(bus), session_(bus, config.graph_optimizer, JournalConfig{config.launch.map + "/journal"}, EstimatorSession::kReadOnly),
        relocalizer_(config.scan_matcher.sigma_range_m, config.scan_matcher.range_limit_m) {
    if (!session_.resumed()) throw std::runtime_error("launch.map '" + config.launch.map + "' holds no journal of a run on the bus" + session_.words());
    for (std::size_t k = 0; k < session_.nodes().size(); ++k) {
      const graph_node_t& node = session_.nodes()[k];
      relocalizer_.add_node(node.id, session_.estimator().graph().poses[k], to_scan(node.scan), to_sensor_info(node.sensor));
    }
    if (const auto sensor = session_.sensor()) sensor_ = *sensor;
    bus.subscribe<sensor_info_t>(channel::kSensorInfo, [this](const sensor_info_t& m) {
      if (m.sensor == channel::kLaser) sensor_ = to_sensor_info(m);
    });
    bus.subscribe<bot_core::planar_lidar_t>(channel::kLaser, [this](const bot_core::planar_lidar_t& m) {
      scans_.push_back(to_scan(m));
      if (scans_.size() > kScansKept) scans_.pop_front();
      work();
    });
    bus.subscribe<scan_match_t>(channel::kScanMatch, [this](const scan_match_t& m) {
      matches_.push_back(m);
      work();
    });
  }

  void tick(std::int64_t) override { session_.tick(); }
  std::string words() const override {
    return std::to_string(session_.nodes().size()) + " nodes of a saved map, " +
           (located_ ? "located, " : "looking for the robot (" + std::to_string(hypotheses_) + " places fit), ") + std::to_string(poses_) + " poses" +
           (times_lost_ ? ", lost " + std::to_string(times_lost_) + " times" : "");
  }

 private:
  /// Behind a hub a match can overtake its scan: then it waits.
  void work() {
    while (!matches_.empty()) {
      if (bus_.is_lossless() && (scans_.empty() || matches_.front().utime > scans_.back().utime)) return;
      on_match(matches_.front());
      matches_.pop_front();
    }
  }

  void on_match(const scan_match_t& message) {
    const auto scan = std::find_if(scans_.begin(), scans_.end(), [&](const Scan& s) { return s.utime == message.utime; });
    if (scan == scans_.end()) return bus_.count_gap(channel::kLaser, 1);
    const Pose2 T_track_base = to_pose(message.T_track_base);
    if (message.track != track_) begin_track(message.track);
    const Relocalizer::Answer answer = located_ ? relocalizer_.locate(*scan, sensor_, T_map_track_ * T_track_base)
                                                : relocalizer_.look(*scan, sensor_, T_track_base);
    scans_.erase(scans_.begin(), scan + 1);
    located_ ? follow(message.utime, T_track_base, answer) : consider(message.utime, T_track_base, answer);
  }

  /// Poses of two tracks have nothing in common: the robot may be anywhere.
  void begin_track(std::int64_t track) {
    times_lost_ += located_;
    located_ = false;
    relocalizer_.forget();
    track_ = track;
  }

  void consider(std::int64_t utime, const Pose2& T_track_base, const Relocalizer::Answer& answer) {
    hypotheses_ = answer.hypotheses;
    if (answer.verdict != Verdict::kOk) return;
    located_ = true;
    failures_ = 0;
    say(utime, T_track_base, answer);
  }

  /// The matcher's own track carries on in directions in which the map says nothing, and altogether while nothing fits.
  void follow(std::int64_t utime, const Pose2& T_track_base, Relocalizer::Answer answer) {
    const Pose2 guess = T_map_track_ * T_track_base;
    const Eigen::Matrix3d by_track = Eigen::Vector3d(1 / (kTrack_m * kTrack_m), 1 / (kTrack_m * kTrack_m), 1 / (kTrack_rad * kTrack_rad)).asDiagonal();
    Eigen::Vector3d step = answer.T_map_base.vector() - guess.vector();
    step[2] = wrap_angle(step[2]);
    const Eigen::Vector3d believed = (answer.information + by_track).ldlt().solve(answer.information * step);
    const bool fits = is_usable(answer.verdict) && believed.head<2>().norm() < kFarStep_m;
    failures_ = fits ? 0 : failures_ + 1;
    if (failures_ >= kFailuresBeforeLost) return begin_track(track_);
    answer.T_map_base = fits ? Pose2(guess.x + believed[0], guess.y + believed[1], wrap_angle(guess.heading + believed[2])) : guess;
    say(utime, T_track_base, answer);
  }

  void say(std::int64_t utime, const Pose2& T_track_base, const Relocalizer::Answer& answer) {
    T_map_track_ = answer.T_map_base * T_track_base.inverse();
    ++poses_;
    session_.place(utime, answer.T_map_base, answer.information, answer.verdict);
  }

  Bus& bus_;
  EstimatorSession session_;
  Relocalizer relocalizer_;
  SensorInfo sensor_;
  std::deque<Scan> scans_;
  std::deque<scan_match_t> matches_;
  Pose2 T_map_track_;
  std::int64_t track_ = -1, poses_ = 0, times_lost_ = 0;
  int failures_ = 0, hypotheses_ = 0;
  bool located_ = false;
};

}  // namespace

std::unique_ptr<Module> make_localizer(Bus& bus, const SystemConfig& config) {
  return std::make_unique<LocalizerModule>(bus, config);
}

}  // namespace modslam
