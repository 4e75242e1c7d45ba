// SPDX-License-Identifier: BSD-3-Clause
/// @file The accumulator of the Hough transform of one scan.
#pragma once
#include <vector>

#include "common/scan/scan.hpp"

namespace modslam {

/// Votes of points for straight lines: buckets over (angle, distance to the first point). Points go again; a row of buckets, all of one angle, learns of that
/// only when it may hold the fullest bucket.
class HoughVotes {
 public:
  /// @param cell_m, cell_rad  width of a bucket in distance and angle.
  HoughVotes(double cell_m, double cell_rad);

  /// Begins anew. At least one point.
  void start(const std::vector<ScanPoint>& points);
  /// Numbers of the points that still vote, in order.
  const std::vector<int>& voters() const { return voters_; }
  /// Points that vote no longer, each named once.
  void take_back(const std::vector<int>& points);

  struct Bucket {
    int votes;
    Eigen::Vector2d normal;
    double distance_m;      ///< of the line in its middle from the points' origin
  };
  /// The bucket with most votes; of those with as many the first.
  Bucket fullest();

 private:
  void vote_all(std::size_t points);
  void bring_up_to_date(int angle);
  std::int16_t* row(int angle) { return votes_.data() + static_cast<std::ptrdiff_t>(angle) * stride_; }

  double cell_m_;
  int angles_, half_ = 0, stride_ = 0;
  Eigen::Vector2d origin_{0, 0};
  Eigen::ArrayXf normal_x_, normal_y_;        ///< of each angle
  Eigen::ArrayXi rows_, buckets_;             ///< where the row of each angle begins; where one point votes
  std::vector<float> x_, y_;                  ///< of each point, from the origin [buckets]
  std::vector<std::int16_t> votes_, most_;    ///< most_: of each angle, at most
  std::vector<int> voters_, gone_;
  std::vector<char> is_gone_;
  std::vector<std::size_t> known_gone_;       ///< of gone_, how many each angle knows of
};

}  // namespace modslam
