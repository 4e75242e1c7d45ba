// SPDX-License-Identifier: BSD-3-Clause
/// @file Scores a path against known motions between two moments.
///
/// Error of a relation = inverse(true motion) * estimated motion; its translation [m] and
/// |rotation| [deg]. Source: Kuemmerle et al., "On measuring the accuracy of SLAM algorithms",
/// Autonomous Robots 2009, eq. 3-4. Stamps of some logs step back in file order, so a stamp is
/// first turned into a place in the file (a scan index, possibly between two scans) and the pose is
/// interpolated between scan indices.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "common/evaluation/path.hpp"
#include "common/evaluation/statistics.hpp"

namespace modslam {

/// True motion of the laser between two stamps: T_laser1_laser2.
struct Relation {
  double stamp1_s = 0, stamp2_s = 0;
  Pose2 motion;
};
/// Lines `t1 t2 x y z roll pitch yaw`. @throws std::runtime_error naming a line that is not one.
std::vector<Relation> parse_relations(std::string_view text);

/// When each scan of a log was taken, in file order.
class ScanTimes {
 public:
  struct Place {
    double index;  ///< scan index, with a fraction between two scans
    bool exact;    ///< the stamp is that of a scan whose own stamp is known exactly
  };

  ScanTimes(std::vector<double> stamps_s, std::vector<bool> exact);
  /// CSV with a header and the columns scan_index, ipc_timestamp and perhaps exact, rows 0, 1, 2,
  /// ...
  /// @throws std::runtime_error naming the line.
  static ScanTimes parse(std::string_view text);

  /// The scan with that stamp (within 1 us); else the place between the two scans that follow each
  /// other in the file and have the stamp between theirs, the closest two where several do; empty
  /// outside the log.
  std::optional<Place> place(double stamp_s) const;
  std::size_t size() const { return stamps_s_.size(); }
  double stamp_s(std::size_t scan) const { return stamps_s_[scan]; }

 private:
  std::vector<double> stamps_s_;
  std::vector<bool> exact_;
  std::vector<std::size_t> by_stamp_;
};

/// Poses at scan indices that ascend; not every scan needs one.
struct IndexedPath {
  std::vector<double> indices;
  std::vector<Pose2> poses;

  /// Interpolated; empty before the first and after the last.
  std::optional<Pose2> at(double index) const;
};

/// Gives each line of a path its scan: line i is scan i when there are as many lines as scans, and
/// otherwise lines find the next scan with their stamp.
/// @throws std::runtime_error when stamps disagree by more than a millisecond or find no scan.
IndexedPath index_path(const Path& path, const ScanTimes& times);

struct RelationScore {
  Statistics translation_m, rotation_deg;
};
struct RelationScores {
  RelationScore all, exact;  ///< exact: both stamps are exact
  std::size_t unplaced = 0;  ///< relations whose stamps lie outside the log or the path: not scored
  std::vector<double> translation_m, rotation_deg;  ///< of each scored relation, in order
};
RelationScores score_relations(const std::vector<Relation>& relations, const ScanTimes& times,
                               const IndexedPath& T_map_laser);

}  // namespace modslam
