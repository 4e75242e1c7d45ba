// SPDX-License-Identifier: BSD-3-Clause
/// @file The virtual sensor: scan after scan against a sliding local map, with a verdict on every answer.
///
/// One scan: predict by odometry; correlative search in a window as wide as the odometry may be wrong; point-to-line refinement;
/// judge (overlap, residuals, free space, degeneracy, odometry). A doubtful answer is searched again widely; what stays
/// doubtful is reported as such and replaced by odometry with its wide covariance. Method "pfister" is the thesis's matcher instead: each
/// scan against the one before, with the covariance that its paper gives it.
#pragma once
#include <deque>
#include <string>

#include "common/config/visitor.hpp"
#include "common/matching/landmarks.hpp"
#include "common/matching/submap.hpp"
#include "common/matching/verdict.hpp"
#include "common/motion/odometry_model.hpp"

namespace modslam {

struct ScanMatcherConfig {
  static constexpr const char* kTable = "scan_matcher";
  std::string method = "submap";
  double sigma_range_m = 0.012;
  double range_limit_m = 40.0;
  double keyframe_m = 0.25;
  double keyframe_rad = 0.25;
  std::int64_t keyframes = 24;
  double window_m = 0.10;
  double window_rad = 0.07;
  double min_overlap = 0.45;
  double max_chi2 = 16.0;
  double max_free_violation = 0.15;
  double information_scale = 0.6;

  void visit(ConfigVisitor& v) {
    v.choice("method", method, {"submap", "pfister"}, "Against a local map with an honest verdict, or scan to scan as the thesis did.");
    v.number("sigma_range_m", sigma_range_m, 1e-4, 0.2, "m", "Range noise of the laser.");
    v.number("range_limit_m", range_limit_m, 1, 200, "m", "Longer beams are not matched.");
    v.number("keyframe_m", keyframe_m, 0.02, 5, "m", "Distance after which a scan joins the local map.");
    v.number("keyframe_rad", keyframe_rad, 0.02, 3.2, "rad", "Turn after which a scan joins the local map.");
    v.integer("keyframes", keyframes, 1, 500, "", "Scans in the local map; the oldest leaves.");
    v.number("window_m", window_m, 0.02, 2, "m", "Half width of the search around the odometry, plus twice the distance driven.");
    v.number("window_rad", window_rad, 0.01, 1, "rad", "Half width of the search in heading, plus half of the turn.");
    v.number("min_overlap", min_overlap, 0, 1, "", "Share of the points that must find a partner.");
    v.number("max_chi2", max_chi2, 0.1, 1000, "", "Largest reduced chi-square of the residuals.");
    v.number("max_free_violation", max_free_violation, 0, 1, "", "Largest share of beams that cross known walls.");
    v.number("information_scale", information_scale, 1e-4, 1, "", "Neighbouring beams err alike: share of their information that counts.");
  }
};

/// T_from_to: motion since the scan before. Matrices are additive in (x, y, heading) of the frame `from`.
struct ScanMatch {
  Pose2 T_track_base;
  Pose2 T_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< laser alone, zero where it saw nothing
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();   ///< laser and odometry together
  Verdict verdict = Verdict::kInvalid;
  MatchFigures figures;
};

class ScanMatcher {
 public:
  ScanMatcher(const ScanMatcherConfig& config, const OdometryModelConfig& odometry_model)
      : config_(config), odometry_model_(odometry_model) {}

  /// @param motion odometry since the last scan, in that scan's robot frame. Ignored for the first scan.
  ScanMatch match(const Scan& scan, const SensorInfo& sensor, const Pose2& motion);

  /// Scans in the local map.
  std::size_t keyframes() const { return keyframes_.size(); }
  /// Counts the scans that ever joined the local map: it grew when the last one did.
  std::int64_t joined() const { return joined_; }
  int failures() const { return failures_; }
  /// Goes on where another matcher of the same configuration stood: its local map, oldest scan first, and its pose.
  struct PlacedScan {
    Scan scan;
    SensorInfo sensor;
    Pose2 T_track_base;
  };
  void resume(const std::vector<PlacedScan>& local_map, const Pose2& T_track_base, int failures);

 private:
  struct Attempt {
    RefineResult fit;
    Observed observed;
    MatchFigures figures;
    Verdict verdict = Verdict::kFailed;
  };
  Attempt best_attempt(const std::vector<OrientedPoint>& points, const SensorInfo& sensor, const Pose2& motion, const Pose2& guess,
                       const Eigen::Matrix3d& cov_guess) const;
  Attempt refine_from(const std::vector<OrientedPoint>& points, const SensorInfo& sensor, const Pose2& start, const Pose2& guess,
                      const Eigen::Matrix3d& cov_guess) const;
  Attempt scan_to_scan(const std::vector<OrientedPoint>& points, const SensorInfo& sensor, double radstep, const Pose2& guess,
                       const Eigen::Matrix3d& cov_guess) const;
  bool is_scan_to_scan() const { return config_.method == "pfister"; }
  Verdict judge(const Attempt& attempt) const;
  double free_violation(const std::vector<OrientedPoint>& points, const SensorInfo& sensor, const Pose2& T) const;
  std::vector<OrientedPoint> points_of(const Scan& scan, const SensorInfo& sensor) const;
  void ask_landmarks(const std::vector<OrientedPoint>& points, const Eigen::Matrix3d& cov_guess, Attempt& attempt) const;
  void add_keyframe(Keyframe keyframe);
  std::vector<const Keyframe*> keyframe_pointers() const;
  void update_submap(const std::vector<OrientedPoint>& points, const SensorInfo& sensor, const ScanMatch& match);

  ScanMatcherConfig config_;
  OdometryModelConfig odometry_model_;
  std::deque<Keyframe> keyframes_;
  Submap submap_;
  mutable Landmarks landmarks_;  ///< of the same keyframes; made when a match first asks for them
  mutable bool landmarks_ready_ = false;
  Pose2 T_track_base_;
  bool started_ = false;
  int failures_ = 0;  ///< in a row
  std::int64_t joined_ = 0;
};

}  // namespace modslam
