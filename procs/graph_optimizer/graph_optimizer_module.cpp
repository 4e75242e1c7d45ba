// SPDX-License-Identifier: BSD-3-Clause
/// procs/graph_optimizer — SCAN_MATCH + LASER + ODOMETRY + INS + LOOP + LOOP_SEARCH (+ SYNC_REQUEST) → POSE, NODE, GRAPH (+ SYNC_REQUEST for a LOOP that was lost).
/// Config: [graph_optimizer], [odometry_model], [scan_matcher] (range noise and limit).
#include <bot_core/planar_lidar_t.hpp>
#include <Eigen/LU>
#include <algorithm>
#include <bot_core/pose_t.hpp>
#include <deque>
#include <modslam/loop_search_t.hpp>
#include <modslam/scan_match_t.hpp>
#include <modslam/sync_request_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/estimator_session.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/scan_source.hpp"
#include "common/bus/system_config.hpp"
#include "common/motion/odometry_buffer.hpp"
#include "common/scan/deskew.hpp"

namespace modslam {
namespace {

// That wait for their match: a fast player sends some thousand messages ahead of the matcher.
constexpr std::size_t kScansKept = 10'000;
constexpr std::int64_t kPatience_us = 2'000'000;
constexpr std::size_t kUnpaired = 50;  // of the newest, that are looked at when odometry comes

class GraphOptimizerModule : public Module {
 public:
  GraphOptimizerModule(Bus& bus, const SystemConfig& config)
      : bus_(bus), model_(config.odometry_model), lockstep_(config.launch.lockstep), session_(bus, config.graph_optimizer, config.journal),
        polish_(config.graph_optimizer.polish) {
    session_.compare_scans({{config.scan_matcher.sigma_range_m, 1e-3}, config.scan_matcher.range_limit_m, config.loop_detector.limits()});
    if (session_.resumed()) resume();
    bus.subscribe<sensor_info_t>(channel::kSensorInfo, [this](const sensor_info_t& m) {
      if (m.sensor == channel::kLaser) sensor_ = to_sensor_info(m);
    });
    bus.subscribe<bot_core::planar_lidar_t>(channel::kLaser, [this](const bot_core::planar_lidar_t& m) {
      scans_.push_back({to_scan(m), odometry_.at(m.utime), ins_.at(m.utime)});
      if (scans_.size() > kScansKept) scans_.pop_front();
    });
    bus.subscribe<bot_core::pose_t>(channel::kOdometry, [this](const bot_core::pose_t& m) { add(odometry_, &WaitingScan::T_odom_base, m); });
    bus.subscribe<bot_core::pose_t>(channel::kIns, [this](const bot_core::pose_t& m) { add(ins_, &WaitingScan::T_ins_base, m); });
    bus.subscribe<scan_match_t>(channel::kScanMatch, [this](const scan_match_t& m) {
      matches_.push_back(m);
      work();
    });
    bus.subscribe<loop_search_t>(channel::kLoopSearch, [this](const loop_search_t& m) {
      searched_ = std::max(searched_, m.node);
      work();
    });
    bus.subscribe<loop_closure_t>(channel::kLoop, [this](const loop_closure_t& m) { session_.add_loop(to_loop(m)); });
  }

  void finish() override {
    lockstep_ = patient_ = false;
    work();
    session_.finish();
    if (polish_) session_.polish();
  }
  void tick(std::int64_t steady_us) override {
    session_.tick();
    if (matches_.empty() || worked_) blocked_since_us_ = steady_us;
    worked_ = false;
    patient_ = steady_us - blocked_since_us_ <= (bus_.is_lossless() ? 5 : 1) * kPatience_us;  // the loop detector is dead or was never started, or the scan is lost
    if (!patient_) searched_ = nodes();
    work();
  }
  bool command(const std::string& verb) override {
    if (verb != "polish") return false;
    session_.polish();
    return true;
  }
  bool complete() const override { return matches_.empty(); }
  std::string words() const override { return session_.words(); }
  void missed(const std::string& channel) override {
    if (channel != channel::kLoop) return;
    sync_request_t message{};
    message.utime = bus_.utime();
    message.requester = bus_.name();
    bus_.publish(channel::kSyncRequest, message);
  }
  std::optional<Resumption> resumption() const override {
    if (!session_.resumed()) return std::nullopt;
    return Resumption{{channel::kScanMatch, channel::kLaser, channel::kOdometry, channel::kIns, channel::kSensorInfo, channel::kLoop},
                      channel::kScanMatch, session_.state().utime, session_.resumed_from_us()};
  }

 private:
  struct Sources {
    Pose2 T_track_base, T_odom_base, T_ins_base;
    bool odometry = false, ins = false;
  };

  /// Where the life before stood, from its journal.
  void resume() {
    const estimator_state_t& state = session_.tracking();
    if (const auto sensor = session_.sensor()) sensor_ = *sensor;
    track_ = state.track;
    seq_ = state.match_seq;
    last_.T_track_base = to_pose(state.T_track_base);
    last_.odometry = state.has_odometry != 0;
    last_.T_odom_base = to_pose(state.T_odom_base);
    last_.ins = state.has_ins != 0;
    last_.T_ins_base = to_pose(state.T_ins_base);
    any_ = started_in_track_ = true;
  }

  void remember(const scan_match_t& message, const Sources& now) {
    estimator_state_t& state = session_.tracking();
    state.track = track_ = message.track;
    state.match_seq = seq_ = message.seq;
    put(state.T_track_base, now.T_track_base);
    state.has_odometry = now.odometry;
    put(state.T_odom_base, now.T_odom_base);
    state.has_ins = now.ins;
    put(state.T_ins_base, now.T_ins_base);
    last_ = now;
    any_ = started_in_track_ = true;
  }

  /// A scan and where the sources say that it was taken, looked up as soon as they cover its time: in a log whose stamps step back the
  /// same time comes twice, and who looks later finds another place.
  struct WaitingScan {
    Scan scan;
    std::optional<Pose2> T_odom_base, T_ins_base;
  };

  void add(OdometryBuffer& buffer, std::optional<Pose2> WaitingScan::*place, const bot_core::pose_t& message) {
    const TimedPose pose = to_timed_pose(message);
    buffer.add(pose.utime, pose.pose);
    const std::size_t first = scans_.size() > kUnpaired ? scans_.size() - kUnpaired : 0;
    for (std::size_t k = first; k < scans_.size(); ++k)
      if (!(scans_[k].*place)) scans_[k].*place = buffer.at(scans_[k].scan.utime);
  }

  NodeId nodes() const { return static_cast<NodeId>(session_.estimator().graph().poses.size()); }

  /// In lockstep no match is taken before the newest node was searched for loops: then the player's speed changes nothing.
  void work() {
    while (!matches_.empty() && (!lockstep_ || searched_ >= nodes() - 1) && !(patient_ && awaits_sources(matches_.front()))) {
      worked_ = true;
      const scan_match_t match = std::move(matches_.front());
      matches_.pop_front();
      on_match(match);
    }
  }

  /// Whether a part of what belongs to a match was lost on the way and is being repeated, or was overtaken by the match behind a hub.
  bool awaits_sources(const scan_match_t& match) {
    const auto scan = std::find_if(scans_.begin(), scans_.end(), [&](const WaitingScan& w) { return w.scan.utime == match.utime; });
    if (bus_.is_lossless()) {
      if (scan == scans_.end()) return scans_.empty() || scans_.back().scan.utime < match.utime;  // else it came while this process was dead
      return !scan->T_odom_base && odometry_may_come(scan->scan.utime);
    }
    if (scan != scans_.end())
      return (!scan->T_odom_base && bus_.awaits(channel::kOdometry)) || (!scan->T_ins_base && bus_.awaits(channel::kIns));
    bus_.suspect(channel::kLaser);
    return bus_.awaits(channel::kLaser);
  }

  /// As long as the matcher itself would wait for it.
  bool odometry_may_come(std::int64_t utime) const {
    return odometry_.newest_utime() < utime && scans_.back().scan.utime - utime <= ScanSource::kPatience_us;
  }

  void on_match(const scan_match_t& message) {
    const bool old_track = message.track != track_ && message.utime <= session_.state().utime;
    if (any_ && message.seq <= seq_ && (message.track == track_ || old_track)) {  // said twice, or late: its motion is accounted for
      ++repeated_;
      return;
    }
    const Pose2 T_track_base = to_pose(message.T_track_base);
    MotionMeasurement laser{to_pose(message.T_from_to), to_matrix(message.information)};
    const WaitingScan waiting = take_scan(message.utime);
    const Sources now = sources_of(waiting, T_track_base);

    if (message.track != track_) {
      started_in_track_ = false;  // the matcher was restarted: only odometry spans the break
    } else if (message.seq > seq_ + 1) {
      // Matches were lost on the way; their motions are still in the matcher's own frame.
      bus_.count_gap(channel::kScanMatch, message.seq - seq_ - 1);
      laser.T_from_to = between(last_.T_track_base, T_track_base);
      laser.information /= static_cast<double>(message.seq - seq_);
    }
    std::vector<MotionMeasurement> measurements;
    if (any_) {
      if (started_in_track_) measurements.push_back(laser);
      add_odometry(now, measurements);
      if (measurements.empty()) measurements.push_back({Pose2(), Eigen::Matrix3d::Identity()});
    }
    remember(message, now);
    session_.step(waiting.scan, sensor_, measurements, static_cast<Verdict>(message.verdict));
  }

  void add_odometry(const Sources& now, std::vector<MotionMeasurement>& measurements) const {
    if (now.odometry && last_.odometry) {
      const Pose2 motion = between(last_.T_odom_base, now.T_odom_base);
      const Eigen::Matrix3d information = odometry_covariance(motion, model_).inverse();
      const Eigen::Matrix3d laser = measurements.empty() ? Eigen::Matrix3d::Zero().eval() : measurements.front().information;
      measurements.push_back({motion, information_where_better(information, laser)});
    }
    if (now.ins && last_.ins) {
      const double turn_rad = wrap_angle(now.T_ins_base.heading - last_.T_ins_base.heading);
      measurements.push_back({{0, 0, turn_rad}, ins_information(turn_rad, model_)});
    }
  }

  Sources sources_of(const WaitingScan& waiting, const Pose2& T_track_base) const {
    Sources sources;
    sources.T_track_base = T_track_base;
    const auto odometry = waiting.T_odom_base ? waiting.T_odom_base : odometry_.newest();
    sources.odometry = odometry.has_value();
    sources.T_odom_base = odometry.value_or(Pose2());
    sources.ins = waiting.T_ins_base.has_value();
    sources.T_ins_base = waiting.T_ins_base.value_or(Pose2());
    return sources;
  }

  /// The scan of that time, out of the queue with all before it. An empty one when it never arrived.
  WaitingScan take_scan(std::int64_t utime) {
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      if (scans_[k].scan.utime != utime) continue;
      WaitingScan waiting = std::move(scans_[k]);
      scans_.erase(scans_.begin(), scans_.begin() + static_cast<std::ptrdiff_t>(k) + 1);
      if (sensor_.sweep_s > 0)
        if (const auto T_last_first = odometry_.during(utime, sensor_.sweep_s)) waiting.scan = deskew(waiting.scan, sensor_, *T_last_first);
      return waiting;
    }
    bus_.count_gap(channel::kLaser, 1);
    WaitingScan lost{{}, odometry_.at(utime), ins_.at(utime)};
    lost.scan.utime = utime;
    lost.scan.ranges_m.assign(1, 0.0f);
    return lost;
  }

  Bus& bus_;
  OdometryModelConfig model_;
  bool lockstep_, worked_ = false, patient_ = true;
  std::deque<scan_match_t> matches_;
  NodeId searched_ = 0;  ///< newest node that was looked at for loops; the first one has nobody to be compared with
  std::int64_t blocked_since_us_ = 0;
  EstimatorSession session_;
  bool polish_;
  SensorInfo sensor_;
  OdometryBuffer odometry_, ins_;
  std::deque<WaitingScan> scans_;
  Sources last_;
  std::int64_t track_ = 0, seq_ = -1, repeated_ = 0;
  bool any_ = false, started_in_track_ = false;
};

}  // namespace

std::unique_ptr<Module> make_graph_optimizer(Bus& bus, const SystemConfig& config) {
  return std::make_unique<GraphOptimizerModule>(bus, config);
}

}  // namespace modslam
