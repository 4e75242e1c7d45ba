// SPDX-License-Identifier: BSD-3-Clause
/// @file Proposal distribution (thesis 3.3.2): one motion from all pseudo-odometry sensors.
#pragma once
#include <Eigen/Core>
#include <random>
#include <vector>

#include "common/geometry/pose2.hpp"

namespace modslam {

/// What one sensor says about the motion between two scans; information additive in (x, y, heading) of the frame it starts
/// from, zero in directions the sensor does not see.
struct MotionMeasurement {
  Pose2 T_from_to;
  Eigen::Matrix3d information;
};

struct Proposal {
  Pose2 T_from_to;
  Eigen::Matrix3d covariance;
};

/// Maximum likelihood of all measurements (deterministic proposal). At least one must be informative in each direction;
/// what nobody saw gets a variance of 100 m^2 or rad^2.
Proposal fuse(const std::vector<MotionMeasurement>& measurements);

/// A draw from the fused Gaussian (probabilistic proposal); own Box-Muller, the same on every machine.
/// The part of `information` (positive definite) in the directions that `other` (may be singular) knows less of. For a source whose errors
/// are systematic: an odometer that is a little wrong the same way at every step must not be averaged with one that is not.
Eigen::Matrix3d information_where_better(const Eigen::Matrix3d& information, const Eigen::Matrix3d& other);

Pose2 sample(const Proposal& proposal, std::mt19937_64& random);

}  // namespace modslam
