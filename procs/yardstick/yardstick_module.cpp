// SPDX-License-Identifier: BSD-3-Clause
/// procs/yardstick — LASER + ODOMETRY or GROUND_TRUTH (+ SYNC_REQUEST) → POSE, NODE, GRAPH. Config: [launch] estimator.
/// The estimator that believes one source: what maps look like without SLAM, or with perfect localisation.
#include "common/bus/channels.hpp"
#include "common/bus/conversions.hpp"
#include "common/bus/estimator_session.hpp"
#include "common/bus/modules.hpp"
#include "common/bus/scan_source.hpp"
#include "common/bus/system_config.hpp"

namespace modslam {
namespace {

class YardstickModule : public Module {
 public:
  YardstickModule(Bus& bus, const SystemConfig& config)
      : session_(bus, config.graph_optimizer, config.journal),
        source_(bus, config.launch.estimator == "ground_truth" ? channel::kGroundTruth : channel::kOdometry,
                [this](const Scan& scan, const Pose2& T_odom_base) { step(scan, T_odom_base); }) {
    if (const auto sensor = session_.sensor()) source_.set_sensor(*sensor);
    if (session_.resumed()) T_odom_last_ = to_pose(session_.tracking().T_odom_base);
  }

  void finish() override {
    source_.flush();
    session_.finish();
  }
  void tick(std::int64_t) override { session_.tick(); }
  std::string words() const override { return session_.words(); }
  std::optional<Resumption> resumption() const override {
    if (!session_.resumed()) return std::nullopt;
    return Resumption{{channel::kLaser, channel::kOdometry, channel::kGroundTruth, channel::kSensorInfo}, channel::kLaser,
                      session_.state().utime, session_.resumed_from_us()};
  }

 private:
  void step(const Scan& scan, const Pose2& T_odom_base) {
    std::vector<MotionMeasurement> measurements;
    if (T_odom_last_) measurements.push_back({between(*T_odom_last_, T_odom_base), 1e8 * Eigen::Matrix3d::Identity()});
    put(session_.tracking().T_odom_base, T_odom_base);
    session_.step(scan, source_.sensor(), measurements, T_odom_last_ ? Verdict::kOk : Verdict::kFirst);
    T_odom_last_ = T_odom_base;
  }

  EstimatorSession session_;
  ScanSource source_;
  std::optional<Pose2> T_odom_last_;
};

}  // namespace

std::unique_ptr<Module> make_yardstick(Bus& bus, const SystemConfig& config) {
  return std::make_unique<YardstickModule>(bus, config);
}

}  // namespace modslam
