// SPDX-License-Identifier: BSD-3-Clause
/// @file What an importer found in a foreign log: sweeps with the robot's odometry, in file order,
/// and everything that it could not use, so that nothing is lost in silence.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "common/scan/scan.hpp"

namespace modslam {

/// One sweep and where odometry had the robot at that moment.
struct RecordedScan {
  Scan scan;
  Pose2 T_odom_base;
  std::optional<Pose2> T_odom_laser;  ///< where the file itself says the laser was
};

struct Recording {
  std::vector<RecordedScan> scans;    ///< in file order; stamps may step back
  std::optional<Pose2> T_base_laser;  ///< mount as the file's header or objects state it
  double sweep_s = 0;                 ///< from the first to the last beam of a sweep, where it is known
  double range_limit_m = 0;           ///< what the file states as the laser's reach; 0: nothing
  std::int64_t other_entries =
      0;  ///< well-formed but of no use here: parameters, comments, other sensors
  std::int64_t odometry_entries = 0;    ///< wheel poses between sweeps; the sweeps carry their own
  std::int64_t broken_entries = 0;      ///< skipped
  std::int64_t negative_ranges = 0;     ///< taken as missing returns
  std::vector<std::string> complaints;  ///< the first few broken entries: where and why

  void complain(const std::string& where_and_why) {
    constexpr std::size_t kSaid = 5;
    ++broken_entries;
    if (complaints.size() < kSaid) complaints.push_back(where_and_why);
  }
};

/// Facts of a recording for a person to check.
struct RecordingSummary {
  std::size_t scans = 0, min_beams = 0, max_beams = 0;
  double duration_s = 0;        ///< from the smallest to the largest stamp
  double odometry_m = 0;        ///< sum of the odometry's steps
  std::int64_t steps_back = 0;  ///< sweeps whose stamp is before that of the sweep before
  double largest_step_back_s = 0;
  std::int64_t repeated_stamps =
      0;  ///< sweeps with the stamp of the sweep before: such a log has lost its time
};
RecordingSummary summarize(const Recording& recording);

/// The value that this laser writes for a missing return: the largest that recurs, where it stands
/// out from its neighbourhood (81.83 or 81.91 m for many SICKs). Empty when none does; 0 always
/// means a missing return.
std::optional<double> find_no_return(const Recording& recording);

/// Mount: what the file states, or else the constant difference between its laser and robot poses;
/// empty when it tells neither.
std::optional<Pose2> find_mount(const Recording& recording);

/// Limits for SENSOR_INFO. The bound stands 0.5 % below the missing-return value because error
/// codes of one laser lie that close together; without such a value it stands above the longest
/// range.
SensorInfo sensor_of(const Recording& recording, const Pose2& T_base_laser,
                     std::optional<double> no_return_m);

}  // namespace modslam
