// SPDX-License-Identifier: BSD-3-Clause
/// @file What a matcher thinks of its own answer, with the figures behind it.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "common/matching/point_to_line.hpp"

namespace modslam {

enum class Verdict : std::int8_t {
  kInvalid = 0,
  kOk = 1,
  kDegenerate = 2,    ///< good, but silent in one direction
  kAmbiguous = 3,     ///< another place fits as well
  kLowOverlap = 4,    ///< too little of the scan is in the map
  kInconsistent = 5,  ///< beams cross known walls, or residuals are larger than noise explains
  kFailed = 6,
  kFirst = 7          ///< nothing to match against yet
};

const char* to_string(Verdict verdict);

/// Whether the match may become an edge.
inline bool is_usable(Verdict verdict) { return verdict == Verdict::kOk || verdict == Verdict::kDegenerate; }

struct MatchFigures {
  double overlap = 0, chi2 = 0, ambiguity = 0, free_violation = 0, innovation = 0, score = 0;
  double degenerate_rad = 0;  ///< direction of no information, map frame (verdict kDegenerate)
  double normal_ratio = 0;
  int points = 0, iterations = 0;
};

/// Information with the directions taken out that the scan did not observe.
struct Observed {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< order x y heading; singular when degenerate
  bool degenerate = false;
  double degenerate_rad = 0;  ///< direction of the weakest translation
  /// Takes a difference of poses to its part in the unobserved directions; zero when all were observed.
  Eigen::Matrix3d unobserved = Eigen::Matrix3d::Zero();
  /// As in a corridor: heading and one translation are known.
  bool lacks_one_translation() const {
    return degenerate && unobserved.topLeftCorner<2, 2>().trace() < 1.1 && std::abs(unobserved(2, 2)) < 0.3;
  }
};

/// Splits H - S into observed and unobserved directions; heading is scaled by 3 m so that units agree. A direction is unobserved when
/// its information is not clearly above what noisy normals fake (5 S), its sigma exceeds `max_sigma_m`, or it is less than `min_share` of
/// the best known direction's: then it hangs on a handful of points. Nor is a translation observed when less than six tenths
/// of the scan's surfaces that face along it have a partner: niches of another corridor fit by chance, but not most of them; and fewer than six points fix nothing.
/// Source: Zhang, Kaess, Singh, ICRA 2016 (remapping); the correction by S is measured in docs/decisions.md.
Observed observed_information(const RefineResult& fit, double max_sigma_m = 0.03, double min_share = 0.0);

}  // namespace modslam
