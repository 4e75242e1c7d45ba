// SPDX-License-Identifier: BSD-3-Clause
#include "common/matching/verdict.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace modslam {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kOk: return "ok";
    case Verdict::kDegenerate: return "degenerate";
    case Verdict::kAmbiguous: return "ambiguous";
    case Verdict::kLowOverlap: return "low overlap";
    case Verdict::kInconsistent: return "inconsistent";
    case Verdict::kFailed: return "failed";
    case Verdict::kFirst: return "first";
    case Verdict::kInvalid: break;
  }
  return "invalid";
}

namespace {

constexpr double kMinOverlapAlong = 0.6, kFewestPointsAlong = 6;

/// Whether a translation was measured by few of the scan's surfaces that face along it, or by hardly any at all.
bool hangs_on_chance(const RefineResult& fit, const Eigen::Vector3d& v) {
  const Eigen::Vector2d t = v.head<2>();
  if (t.norm() < 0.7) return false;  // a turn: all surfaces speak of it
  const double matched = t.dot(fit.normals_matched * t), seen = t.dot(fit.normals_seen * t);
  return matched < kFewestPointsAlong * t.squaredNorm() || matched < kMinOverlapAlong * seen;
}

}  // namespace

Observed observed_information(const RefineResult& fit, double max_sigma_m, double min_share) {
  constexpr double kLever_m = 3.0;
  const Eigen::Vector3d scale(1, 1, 1 / kLever_m);
  const Eigen::Matrix3d D = scale.asDiagonal();
  const Eigen::Matrix3d H = D * fit.information * D, S = D * fit.spurious * D;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(H);

  Observed out;
  Eigen::Matrix3d kept = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d v = eigen.eigenvectors().col(k);
    const double lambda = eigen.eigenvalues()[k], spurious = v.dot(S * v);
    const double honest = lambda - 2 * spurious;
    if (lambda < 5 * spurious || honest <= 0 || 1 / std::sqrt(honest) > max_sigma_m ||
        lambda < min_share * eigen.eigenvalues()[2] || hangs_on_chance(fit, v)) {
      if (!out.degenerate) out.degenerate_rad = std::atan2(v.y(), v.x());
      out.degenerate = true;
      out.unobserved += D * v * v.transpose() * scale.cwiseInverse().asDiagonal();
    } else {
      kept += (lambda - spurious) * v * v.transpose();
    }
  }
  const Eigen::Matrix3d D_inverse = scale.cwiseInverse().asDiagonal();
  out.information = D_inverse * kept * D_inverse;
  return out;
}

}  // namespace modslam
